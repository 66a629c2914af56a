#include "isochor/ecles/reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <numeric>
#include <random>

#include "ecles/matrix_tables.h"
#include "ecles/random_edits.h"
#include "ecles/rational_elimination.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using test::column_of;
using test::random_system;
using test::random_values;
using test::Size;
using test::System;
using test::Table;
using test::table_of;
using test::terms_of;

constexpr Simplification kAll[] = {Simplification::kNone, Simplification::kGcd,
                                   Simplification::kTurner};

RationalMatrix points(const std::vector<std::vector<Rational>>& rows) {
  RationalMatrix result(static_cast<int>(rows.size()), static_cast<int>(rows.at(0).size()));
  for (int i = 0; i < result.rows(); ++i) {
    for (int c = 0; c < result.columns(); ++c) {
      result.set(i, c, rows[static_cast<size_t>(i)][static_cast<size_t>(c)]);
    }
  }
  return result;
}

TEST(Reference, Example22FourPumps) {
  // p1 + p2 = p3 and p4 = p3 + 5.
  const ConstraintMatrix pumps(4, {{{0, 1}, {1, 1}, {2, -1}}, {{2, -1}, {3, 1}}});
  const RationalMatrix right = column_of({0, 5});
  const RationalMatrix rates = column_of({1, 2, 3, 8});
  const auto editor = [&](const Selection& selection) {
    return ReferenceEditor(pumps, right, rates, selection);
  };
  // One other pump is enough when the rest may stay.
  const ReferenceEditor pair = editor({{0}, {1}});
  EXPECT_EQ(pair.relevance().rows, std::vector<int>{0});
  EXPECT_EQ(pair.relevance().fixed, std::vector<int>{2});
  EXPECT_TRUE(pair.strongly_solvable());
  EXPECT_EQ(pair.update(column_of({Rational(5, 2)}), column_of({2}))->derived,
            column_of({Rational(1, 2)}));
  // All others follow: the least change.
  const ReferenceEditor all = editor({{0}, {1, 2, 3}});
  EXPECT_EQ(all.update(column_of({4}), column_of({2, 3, 8}))->derived, column_of({0, 4, 9}));
  // The fourth pump does not occur with the first: solvable only where nothing moves.
  const ReferenceEditor wrong = editor({{0}, {3}});
  EXPECT_EQ(wrong.relevance().rows, (std::vector<int>{0, 1}));
  EXPECT_FALSE(wrong.strongly_solvable());
  EXPECT_TRUE(wrong.weakly_solvable(column_of({1})));
  EXPECT_FALSE(wrong.weakly_solvable(column_of({2})));
  EXPECT_EQ(wrong.update(column_of({2}), column_of({8})), std::nullopt);
  EXPECT_EQ(wrong.update(column_of({1}), column_of({70}))->derived, column_of({8}));
}

TEST(Reference, Figure21Parallelogram) {
  // p0 + p2 = p1 + p3; a fifth point has no constraint.
  const ConstraintMatrix parallelogram(5, {{{0, 1}, {1, -1}, {2, 1}, {3, -1}}});
  const RationalMatrix now = points({{0, 0}, {4, 0}, {5, 2}, {1, 2}, {9, 9}});
  const ReferenceEditor editor(parallelogram, RationalMatrix(1, 2), now, {{0}, {1, 2, 3}});
  EXPECT_TRUE(editor.values_are_feasible());
  EXPECT_TRUE(editor.strongly_solvable());
  EXPECT_TRUE(editor.relevance().fixed.empty());
  // The corner is dragged by (-3, 6), the others want to stay: each takes a third.
  const auto result = editor.update(points({{-3, 6}}), points({{4, 0}, {5, 2}, {1, 2}}));
  ASSERT_TRUE(result.has_value());
  EXPECT_EQ(result->derived, points({{3, 2}, {6, 0}, {0, 4}}));
  // A weight that holds the opposite corner leaves more to its neighbours.
  const auto held = editor.update(points({{-3, 6}}), points({{4, 0}, {5, 2}, {1, 2}}), {1, 4, 1});
  EXPECT_EQ(held->derived, points({{Rational(8, 3), Rational(8, 3)},
                                   {Rational(16, 3), Rational(4, 3)},
                                   {Rational(-1, 3), Rational(14, 3)}}));
}

TEST(Reference, Example92LeastSquares) {
  const Table rows = table_of(test::integers(
      {{4, 9, 16, 29}, {-1, -6, -19, -16}, {1, 5, 15, 19}, {5, 6, -1, -12}, {5, 10, 15, 20}}));
  const ConstraintMatrix matrix(4, terms_of(rows));
  for (const Simplification simplification : kAll) {
    const ReferenceEditor editor(matrix, column_of({142, 42, 40, -128, 50}), RationalMatrix(4, 1),
                                 {{}, {0, 1, 2, 3}}, simplification);
    EXPECT_EQ(editor.rank(), 3);
    const auto result = editor.update(RationalMatrix(0, 1), column_of({1, 1, 1, 1}));
    ASSERT_TRUE(result.has_value());
    EXPECT_EQ(result->derived, column_of({Rational(3, 2), Rational(-3, 2), Rational(-23, 2),
                                          Rational(23, 2)}));  // (9.13)
  }
  // The multipliers of (9.12) belong to the printed choice of independent rows.
  const ConstraintMatrix printed(4, terms_of({rows[1], rows[2], rows[0]}));
  const ReferenceEditor editor(printed, column_of({42, 40, 142}), RationalMatrix(4, 1),
                               {{}, {0, 1, 2, 3}});
  ASSERT_EQ(editor.independent(), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(editor.update(RationalMatrix(0, 1), column_of({1, 1, 1, 1}))->multipliers,
            column_of({Rational(-123, 20), Rational(-23, 4), Rational(-7, 20)}));
}

TEST(Reference, RelevantMeansNonzero) {
  // Algorithm 2 as printed would take every row; the third has no chosen parameter.
  const ConstraintMatrix matrix(
      4, {{{0, 1}, {1, 1}}, {{1, 2}, {3, 1}}, {{3, 5}}, {}, {{0, 1}, {0, -1}, {2, 1}}});
  const Relevance relevance = extract_relevant(matrix, {{0}, {1}});
  EXPECT_EQ(relevance.rows, (std::vector<int>{0, 1}));
  EXPECT_EQ(relevance.fixed, std::vector<int>{3});
  EXPECT_TRUE(extract_relevant(matrix, {}).rows.empty());
  EXPECT_THROW((void)extract_relevant(matrix, {{4}, {}}), PreconditionError);
  EXPECT_THROW((void)extract_relevant(matrix, {{-1}, {}}), PreconditionError);
  EXPECT_THROW((void)extract_relevant(matrix, {{1}, {0, 1}}), PreconditionError);
}

TEST(Reference, StrongDoesNotDependOnValues) {
  // x + y = 1 twice, once doubled wrongly: no values satisfy it, yet y can follow any x as well as
  // it could before. (8.15) would call this not strongly solvable.
  const ConstraintMatrix matrix(2, {{{0, 1}, {1, 1}}, {{0, 2}, {1, 2}}});
  const ReferenceEditor editor(matrix, column_of({1, 3}), column_of({0, 1}), {{0}, {1}});
  EXPECT_TRUE(editor.strongly_solvable());
  EXPECT_FALSE(editor.values_are_feasible());
  EXPECT_FALSE(editor.weakly_solvable(column_of({0})));
  EXPECT_EQ(editor.redundant().size(), 1u);
}

// The given rows of E, and their entries in the chosen columns, without the engine's help.
struct Naive {
  std::vector<size_t> rows;
  Table derived, anchors;
};
Naive naive(const System& system) {
  Naive result;
  for (size_t i = 0; i < system.rows.size(); ++i) {
    const auto picked = [&](const std::vector<int>& chosen) {
      std::vector<Rational> entries;
      for (const int j : chosen) entries.push_back(system.rows[i][static_cast<size_t>(j)]);
      return entries;
    };
    const auto derived = picked(system.selection.derived);
    const auto anchors = picked(system.selection.anchors);
    const auto nonzero = [](const Rational& entry) { return !entry.is_zero(); };
    if (std::none_of(derived.begin(), derived.end(), nonzero) &&
        std::none_of(anchors.begin(), anchors.end(), nonzero)) {
      continue;
    }
    result.rows.push_back(i);
    result.derived.push_back(derived);
    result.anchors.push_back(anchors);
  }
  return result;
}

// q_E - R_E x for all parameters at x, the given rows.
Table residual(const System& system, const Naive& relevant, const RationalMatrix& x) {
  Table result;
  for (const size_t i : relevant.rows) {
    std::vector<Rational> row;
    for (int c = 0; c < system.components; ++c) {
      row.push_back(system.right.at(static_cast<int>(i), c));
      for (int j = 0; j < system.parameters; ++j) {
        const Rational& entry = system.rows[i][static_cast<size_t>(j)];
        if (!entry.is_zero()) row.back() -= entry * x.at(j, c);
      }
    }
    result.push_back(row);
  }
  return result;
}

bool all_zero(const Table& table) {
  return std::all_of(table.begin(), table.end(), [](const auto& row) {
    return std::all_of(row.begin(), row.end(), [](const auto& entry) { return entry.is_zero(); });
  });
}

// What the random systems turned out to be: each kind must occur.
struct Seen {
  int strong = 0;
  int weak_only = 0;
  int refused = 0;
  int minimised = 0;
};

// (9.4): 2 w (p'' - p') + A^^T Lambda == 0, where A^ are the stored multiples of the given rows.
void expect_multipliers(const ConstraintMatrix& matrix, const System& system,
                        const std::vector<int>& independent, const ReferenceSolution& solution,
                        const Table& weighted_change) {
  ASSERT_EQ(static_cast<size_t>(solution.multipliers.rows()), independent.size());
  for (size_t s = 0; s < weighted_change.size(); ++s) {
    const auto parameter = static_cast<size_t>(system.selection.derived[s]);
    for (int c = 0; c < system.components; ++c) {
      Rational sum = weighted_change[s][static_cast<size_t>(c)] * Rational(2);
      for (size_t k = 0; k < independent.size(); ++k) {
        const Rational& given = system.rows[static_cast<size_t>(independent[k])][parameter];
        sum +=
            matrix.scale(independent[k]) * given * solution.multipliers.at(static_cast<int>(k), c);
      }
      EXPECT_TRUE(sum.is_zero());
    }
  }
}

void expect_laws(std::mt19937_64& random, const System& system, Simplification simplification,
                 Seen& seen) {
  const ConstraintMatrix matrix(system.parameters, terms_of(system.rows));
  const ReferenceEditor editor(matrix, system.right, system.values, system.selection,
                               simplification);
  const Naive relevant = naive(system);
  const std::vector<size_t> rows(editor.relevance().rows.begin(), editor.relevance().rows.end());
  ASSERT_EQ(rows, relevant.rows);
  EXPECT_EQ(editor.relevance().rows, isochor::relevant(matrix, system.selection).rows);
  EXPECT_EQ(editor.relevance().fixed, isochor::relevant(matrix, system.selection).fixed);
  const size_t rank = test::rank(relevant.derived);
  ASSERT_EQ(static_cast<size_t>(editor.rank()), rank);
  EXPECT_EQ(editor.independent().size() + editor.redundant().size(), rows.size());
  EXPECT_EQ(editor.strongly_solvable(),
            test::rank(test::beside(relevant.derived, relevant.anchors)) == rank);
  EXPECT_EQ(editor.values_are_feasible(), all_zero(residual(system, relevant, system.values)));

  const auto anchors = static_cast<int>(system.selection.anchors.size());
  const auto derived = static_cast<int>(system.selection.derived.size());
  RationalMatrix target = random_values(random, anchors, system.components);
  const RationalMatrix hints = random_values(random, derived, system.components);
  std::vector<Rational> weights;
  for (int s = 0; s < derived; ++s) weights.emplace_back(1 + static_cast<long>(random() % 9), 4);
  RationalMatrix state = system.values;
  for (int k = 0; k < anchors; ++k) {
    const int parameter = system.selection.anchors[static_cast<size_t>(k)];
    for (int c = 0; c < system.components; ++c) {
      if (random() % 3 == 0) target.set(k, c, system.values.at(parameter, c));
      state.set(parameter, c, target.at(k, c));
    }
  }
  const bool solvable = test::in_column_space(relevant.derived, residual(system, relevant, state));
  EXPECT_EQ(editor.weakly_solvable(target), solvable);
  const auto result = editor.update(target, hints, weights);
  ASSERT_EQ(result.has_value(), solvable);
  if (editor.strongly_solvable()) ++seen.strong;
  if (!result) ++seen.refused;
  if (result && !editor.strongly_solvable()) ++seen.weak_only;
  if (result && rank > 0 && static_cast<int>(rank) < derived) ++seen.minimised;
  if (!result) return;

  // The constraints as given hold, and the weighted change lies in their row space: since it is
  // then orthogonal to every change that keeps them, it is the least.
  Table change(static_cast<size_t>(derived));
  for (int s = 0; s < derived; ++s) {
    const int parameter = system.selection.derived[static_cast<size_t>(s)];
    for (int c = 0; c < system.components; ++c) {
      state.set(parameter, c, result->derived.at(s, c));
      change[static_cast<size_t>(s)].push_back(weights[static_cast<size_t>(s)] *
                                               (result->derived.at(s, c) - hints.at(s, c)));
    }
  }
  EXPECT_TRUE(all_zero(residual(system, relevant, state)));
  if (static_cast<int>(rank) < derived) {
    expect_multipliers(matrix, system, editor.independent(), *result, change);
  } else {
    EXPECT_EQ(result->multipliers.rows(), 0);
  }
  EXPECT_TRUE(test::in_column_space(
      test::transposed(relevant.derived, static_cast<size_t>(derived)), change));
}

TEST(Reference, LawsOnSmallSystemsOfEveryShape) {
  std::mt19937_64 random(51);
  Seen seen;
  for (int round = 0; round < 400; ++round) {
    const int rows = static_cast<int>(random() % 9);
    const int columns = static_cast<int>(random() % 10);
    const int components = static_cast<int>(random() % 4);
    const int rank = round % 3 == 0 ? -1 : static_cast<int>(random() % 6);
    const auto size = static_cast<Size>(round % 4);
    const System system = random_system(
        random, {rows, columns, rank, round % 2 == 0 ? 1.0 : 0.4, 4}, size, components);
    SCOPED_TRACE(::testing::Message() << "seed 51, round " << round);
    for (const Simplification simplification : kAll) {
      // Without simplification the long entries double with each step.
      if (simplification == Simplification::kNone && size != Size::kPlain) continue;
      expect_laws(random, system, simplification, seen);
    }
  }
  std::cout << "seed 51: strongly solvable " << seen.strong << ", only weakly " << seen.weak_only
            << ", refused " << seen.refused << ", minimised " << seen.minimised << "\n";
  EXPECT_GT(seen.strong, 100);
  EXPECT_GT(seen.weak_only, 50);
  EXPECT_GT(seen.refused, 100);
  EXPECT_GT(seen.minimised, 50);
}

TEST(Reference, LawsOnLargerSystems) {
  const struct {
    test::RandomMatrix matrix;
    Size size;
  } cases[] = {
      {{60, 60, -1, 1.0, 4}, Size::kPlain},   {{60, 60, 20, 1.0, 3}, Size::kPlain},
      {{60, 60, -1, 0.05, 10}, Size::kPlain}, {{60, 60, -1, 0.05, 10}, Size::kHuge},
      {{60, 60, -1, 0.04, 10}, Size::kTiny},  {{60, 60, -1, 0.03, 10}, Size::kBoth},
      {{40, 60, 30, 0.2, 3}, Size::kPlain},   {{60, 30, 10, 0.3, 3}, Size::kTiny},
      {{15, 20, -1, 1.0, 8}, Size::kBoth},    {{20, 15, 7, 1.0, 8}, Size::kHuge},
  };
  unsigned long seed = 5200;
  Seen seen;
  for (const auto& [matrix, size] : cases) {
    ++seed;
    for (const Simplification simplification : {Simplification::kGcd, Simplification::kTurner}) {
      std::mt19937_64 random(seed);
      SCOPED_TRACE(::testing::Message() << "seed " << seed << ", " << matrix.rows << " x "
                                        << matrix.columns << ", rank " << matrix.rank);
      expect_laws(random, random_system(random, matrix, size, 1), simplification, seen);
    }
  }
}

TEST(Reference, UpdateStartsFromTheValues) {
  std::mt19937_64 random(53);
  const System system = random_system(random, {4, 9, -1, 1.0, 5}, Size::kPlain, 2);
  const ConstraintMatrix matrix(9, terms_of(system.rows));
  const ReferenceEditor editor(matrix, system.right, system.values, {{0, 1}, {2, 3, 4, 5, 6, 7}});
  const RationalMatrix hints = random_values(random, 6, 2);
  const RationalMatrix first = random_values(random, 2, 2);
  const RationalMatrix before = editor.update(first, hints)->derived;
  (void)editor.update(random_values(random, 2, 2), hints);
  EXPECT_EQ(editor.update(first, hints)->derived, before);
}

TEST(Reference, ArgumentsMustFit) {
  const ConstraintMatrix matrix(3, {{{0, 1}, {1, 1}, {2, 1}}});
  const RationalMatrix right(1, 2);
  const RationalMatrix values(3, 2);
  const Selection selection{{0}, {1, 2}};
  EXPECT_THROW(ReferenceEditor(matrix, RationalMatrix(2, 2), values, selection), PreconditionError);
  EXPECT_THROW(ReferenceEditor(matrix, right, RationalMatrix(2, 2), selection), PreconditionError);
  EXPECT_THROW(ReferenceEditor(matrix, right, RationalMatrix(3, 1), selection), PreconditionError);
  const ReferenceEditor editor(matrix, right, values, selection);
  const RationalMatrix anchor(1, 2);
  const RationalMatrix hints(2, 2);
  EXPECT_THROW((void)editor.weakly_solvable(RationalMatrix(2, 2)), PreconditionError);
  EXPECT_THROW((void)editor.weakly_solvable(RationalMatrix(1, 1)), PreconditionError);
  EXPECT_THROW((void)editor.update(anchor, RationalMatrix(1, 2)), PreconditionError);
  EXPECT_THROW((void)editor.update(anchor, RationalMatrix(2, 1)), PreconditionError);
  EXPECT_THROW((void)editor.update(anchor, hints, {1}), PreconditionError);
  EXPECT_THROW((void)editor.update(anchor, hints, {1, 0}), PreconditionError);
  EXPECT_THROW((void)editor.update(anchor, hints, {1, -1}), PreconditionError);
  EXPECT_TRUE(editor.update(anchor, hints, {1, Rational(1, 1000)}).has_value());
}

}  // namespace
}  // namespace isochor
