#include "isochor/ecles/analysis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "ecles/random_systems.h"
#include "isochor/base/error.h"
#include "isochor/ecles/proof.h"
#include "isochor/ecles/sparse_order.h"

namespace isochor {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

using testing::RandomSystem;
using testing::SystemGenerator;
using testing::SystemKind;

RationalTerms terms(const std::vector<std::pair<int, long>>& list) {
  RationalTerms result;
  for (const auto& [parameter, value] : list) result.emplace_back(parameter, Rational(value));
  return result;
}

TEST(Analysis, KeepsWhatComesFirst) {
  // x0 = x1, x1 = x2, x0 = x2: any one depends on the other two.
  const ConstraintMatrix matrix(
      3, {terms({{0, 1}, {1, -1}}), terms({{1, 1}, {2, -1}}), terms({{0, 1}, {2, -1}})});
  const Selection all{{}, {0, 1, 2}};
  EXPECT_THAT(analyse(matrix, all).dependent, ElementsAre(2));
  AnalysisOptions options;
  options.precedence = {2, 0, 1};
  const Analysis analysis = analyse(matrix, all, options);
  EXPECT_THAT(analysis.independent, ElementsAre(1, 2));
  EXPECT_THAT(analysis.dependent, ElementsAre(0));
  ASSERT_EQ(analysis.circuits.size(), 1u);
  EXPECT_THAT(analysis.circuits[0].rows, ElementsAre(0, 1, 2));
  EXPECT_THAT(analysis.circuits[0].multipliers, ElementsAre(Integer(1), Integer(1), Integer(-1)));
  EXPECT_TRUE(analysis.strongly_solvable());
  EXPECT_EQ(analysis.freedom_left(all), 1);
}

TEST(Analysis, ARowOnAnchorsAloneObstructs) {
  const ConstraintMatrix matrix(2, {terms({{0, 3}}), terms({{0, 1}, {1, 1}})});
  const Analysis analysis = analyse(matrix, {{0}, {1}});
  EXPECT_THAT(analysis.independent, ElementsAre(1));
  EXPECT_THAT(analysis.dependent, ElementsAre(0));
  EXPECT_THAT(analysis.obstructions, ElementsAre(0));
  EXPECT_THAT(analysis.circuits[0].rows, ElementsAre(0));
  EXPECT_FALSE(analysis.strongly_solvable());
}

TEST(Analysis, NothingChosenNothingRelevant) {
  const ConstraintMatrix matrix(2, {terms({{0, 1}}), {}});
  const Analysis none = analyse(matrix, {});
  EXPECT_THAT(none.relevance.rows, IsEmpty());
  EXPECT_EQ(none.rank(), 0);
  EXPECT_TRUE(none.strongly_solvable());
  EXPECT_TRUE(verify(none, matrix, {}));
  const Analysis zero_row = analyse(matrix, {{}, {0, 1}});
  EXPECT_THAT(zero_row.relevance.rows, ElementsAre(0));
  EXPECT_EQ(analyse(ConstraintMatrix(0, {}), {}).work.rows, 0u);
}

TEST(Analysis, OnlyRowsWithNonzeroCoefficientsAreRelevant) {
  const ConstraintMatrix matrix(4, {terms({{0, 1}, {1, 2}, {3, 0}}), terms({{2, 1}, {3, 1}}),
                                    terms({{0, 1}, {0, -1}, {2, 5}})});
  const Relevance relevance = relevant(matrix, {{0}, {3}});
  EXPECT_THAT(relevance.rows, ElementsAre(0, 1));
  EXPECT_THAT(relevance.fixed, ElementsAre(1, 2));
}

TEST(Analysis, RefusesSelectionsThatAreNone) {
  const ConstraintMatrix matrix(2, {terms({{0, 1}})});
  EXPECT_THROW(analyse(matrix, {{0}, {0}}), PreconditionError);
  EXPECT_THROW(analyse(matrix, {{}, {1, 1}}), PreconditionError);
  EXPECT_THROW(analyse(matrix, {{2}, {}}), PreconditionError);
  EXPECT_THROW(analyse(matrix, {{}, {-1}}), PreconditionError);
  AnalysisOptions options;
  options.precedence = {1, 2};
  EXPECT_THROW(analyse(matrix, {{}, {0}}, options), PreconditionError);
}

// The rows' names, whatever their order; multipliers of the given rows up to a common factor.
struct NamedVerdict {
  int rank = 0;
  bool solvable = false;
  std::set<int> independent;
  std::map<int, std::set<int>> circuits;
  bool operator==(const NamedVerdict& other) const {
    return rank == other.rank && solvable == other.solvable && independent == other.independent &&
           circuits == other.circuits;
  }
};

NamedVerdict named(const Analysis& analysis, const std::vector<int>& names) {
  const auto name = [&](int row) { return names[static_cast<size_t>(row)]; };
  NamedVerdict verdict;
  verdict.rank = analysis.rank();
  verdict.solvable = analysis.strongly_solvable();
  for (const int row : analysis.independent) verdict.independent.insert(name(row));
  for (size_t k = 0; k < analysis.circuits.size(); ++k) {
    std::set<int>& members = verdict.circuits[name(analysis.dependent[k])];
    for (const int row : analysis.circuits[k].rows) members.insert(name(row));
  }
  return verdict;
}

TEST(Analysis, DoesNotDependOnOrder) {
  SystemGenerator generator(11);
  std::mt19937 random(12);
  for (int trial = 0; trial < 300; ++trial) {
    const RandomSystem system =
        generator.next(static_cast<SystemKind>(trial % testing::kSystemKinds), 14);
    const size_t m = system.rows.size();
    std::vector<int> precedence(m), rows(m), columns(static_cast<size_t>(system.parameters));
    std::iota(precedence.begin(), precedence.end(), 0);
    std::shuffle(precedence.begin(), precedence.end(), random);
    std::iota(rows.begin(), rows.end(), 0);
    AnalysisOptions options;
    options.precedence = precedence;
    const NamedVerdict expected = named(
        analyse(ConstraintMatrix(system.parameters, system.rows), system.selection, options), rows);

    std::shuffle(rows.begin(), rows.end(), random);
    std::iota(columns.begin(), columns.end(), 0);
    std::shuffle(columns.begin(), columns.end(), random);
    std::vector<RationalTerms> moved;
    options.precedence.clear();
    for (const int row : rows) {
      moved.push_back(system.rows[static_cast<size_t>(row)]);
      // Scaled as well: a constraint is the same constraint whatever its unit.
      const Rational scale(Integer(generator.number(1, 9)), Integer(generator.number(-9, -1)));
      for (auto& term : moved.back()) {
        term.first = columns[static_cast<size_t>(term.first)];
        term.second *= scale;
      }
      options.precedence.push_back(precedence[static_cast<size_t>(row)]);
    }
    Selection selection;
    for (const int j : system.selection.anchors) {
      selection.anchors.push_back(columns[static_cast<size_t>(j)]);
    }
    for (const int j : system.selection.derived) {
      selection.derived.push_back(columns[static_cast<size_t>(j)]);
    }
    std::shuffle(selection.derived.begin(), selection.derived.end(), random);
    const ConstraintMatrix matrix(system.parameters, moved);
    ASSERT_TRUE(named(analyse(matrix, selection, options), rows) == expected) << trial;
  }
}

// Systems side by side: the verdict of the whole is the verdicts of the parts.
TEST(Analysis, BlocksAreDecidedOnTheirOwn) {
  SystemGenerator generator(13);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<RationalTerms> rows;
    Selection selection;
    std::vector<int> dependent;
    int parameters = 0, rank = 0;
    for (int part = 0; part < 3; ++part) {
      const RandomSystem system =
          generator.next(static_cast<SystemKind>((trial + part) % testing::kSystemKinds), 10);
      const Analysis alone =
          analyse(ConstraintMatrix(system.parameters, system.rows), system.selection);
      rank += alone.rank();
      for (const int row : alone.dependent) {
        dependent.push_back(row + static_cast<int>(rows.size()));
      }
      for (RationalTerms row : system.rows) {
        for (auto& term : row) term.first += parameters;
        rows.push_back(std::move(row));
      }
      for (const int j : system.selection.anchors) selection.anchors.push_back(j + parameters);
      for (const int j : system.selection.derived) selection.derived.push_back(j + parameters);
      parameters += system.parameters;
    }
    const Analysis whole = analyse(ConstraintMatrix(parameters, rows), selection);
    ASSERT_EQ(whole.rank(), rank);
    ASSERT_EQ(whole.dependent, dependent);
  }
}

// Long rows are set aside and reduced last; they may yet come first in precedence.
TEST(Analysis, HeavyRowsAreNoException) {
  const int n = 60;
  std::vector<RationalTerms> rows;
  RationalTerms sum;
  for (int j = 0; j + 1 < n; ++j) rows.push_back(terms({{j, 1}, {j + 1, -1}}));
  for (int j = 0; j < n; ++j) sum.emplace_back(j, Rational(j % 2 == 0 ? 1 : -1));
  rows.push_back(sum);  // depends on the differences
  for (int j = 0; j < n; ++j) sum[static_cast<size_t>(j)].second = Rational(1);
  rows.push_back(sum);  // does not
  const ConstraintMatrix matrix(n, rows);
  Selection all;
  for (int j = 0; j < n; ++j) all.derived.push_back(j);
  const Analysis last = analyse(matrix, all);
  EXPECT_EQ(last.rank(), n);
  EXPECT_THAT(last.dependent, ElementsAre(n - 1));
  EXPECT_EQ(last.circuits[0].rows.size(), 1u + n / 2);  // x0 - x1, x2 - x3, ...
  EXPECT_TRUE(verify(last, matrix, all));
  AnalysisOptions options;
  options.precedence.assign(rows.size(), 1);
  options.precedence[n - 1] = 0;
  const Analysis first = analyse(matrix, all, options);
  EXPECT_THAT(first.dependent, ElementsAre(n - 2));
  EXPECT_TRUE(verify(first, matrix, all));
  EXPECT_TRUE(verify_minimal(first.circuits[0], matrix, all.derived));
}

// Every row is planned once, and short ones before the long one that they would fill.
TEST(Analysis, SparseOrderAvoidsFill) {
  std::vector<RationalTerms> rows(1);
  const int n = 40;
  for (int j = 0; j < n; ++j) rows[0].emplace_back(j, Rational(1));
  for (int j = 1; j < n; ++j) rows.push_back(terms({{0, 1}, {j, 2}}));
  const ConstraintMatrix matrix(n, rows);
  internal::Block block;
  for (int j = 0; j < n; ++j) {
    block.rows.push_back(j);
    block.columns.push_back(j);
  }
  const internal::LocalSystem system(matrix, block.rows, block.columns);
  const std::vector<internal::PlannedPivot> plan = internal::sparse_order(system, block);
  std::set<int> seen;
  for (const internal::PlannedPivot& planned : plan) seen.insert(planned.row);
  EXPECT_EQ(plan.size(), block.rows.size());
  EXPECT_EQ(seen.size(), block.rows.size());
  EXPECT_NE(plan[0].row, 0);
  EXPECT_EQ(plan[0].column, plan[0].row);
}

// A block that elimination in the order of precedence would fill: it is reordered, and still the
// first basis comes out.
TEST(Analysis, LargeSparseBlocksAreReordered) {
  std::mt19937 random(21);
  const int n = 300;
  std::vector<RationalTerms> rows;
  for (int i = 0; i < n; ++i) {
    rows.emplace_back();
    for (int k = 0; k < 4; ++k) {
      rows.back().emplace_back(static_cast<int>(random() % n),
                               Rational(static_cast<long>(1 + random() % 5)));
    }
  }
  for (int i = 0; i < 30; ++i) {  // repeated, and the sum of two
    RationalTerms sum = rows[random() % n];
    if (i % 2 == 0) {
      const RationalTerms& other = rows[random() % n];
      sum.insert(sum.end(), other.begin(), other.end());
    }
    rows.push_back(sum);
  }
  Selection all;
  for (int j = 0; j < n; ++j) all.derived.push_back(j);
  AnalysisOptions options;
  for (size_t i = 0; i < rows.size(); ++i) {
    options.precedence.push_back(static_cast<int>(random() % 1000));
  }
  const ConstraintMatrix matrix(n, rows);
  const Analysis analysis = analyse(matrix, all, options);
  EXPECT_TRUE(verify(analysis, matrix, all));
  EXPECT_GE(analysis.dependent.size(), 30u);
  const auto place = [&](int row) {
    return std::make_pair(options.precedence[static_cast<size_t>(row)], row);
  };
  for (size_t k = 0; k < analysis.circuits.size(); ++k) {
    for (const int row : analysis.circuits[k].rows) {
      EXPECT_LE(place(row), place(analysis.dependent[k]));
    }
  }
}

// Rows that agree modulo the first prime, or the first few, are not the same.
TEST(Analysis, PrimesDoNotMislead) {
  Integer product(1);
  for (int k = 0; k < 4; ++k) {
    product *= Integer(static_cast<long>(internal::elimination_prime(k)));
    const Rational p(product);
    // A block that cannot be peeled: columns 0 and 1, with three rows.
    const ConstraintMatrix matrix(
        2, {{{0, Rational(1)}, {1, Rational(2)}}, {{0, Rational(1) + p}, {1, Rational(2)}}});
    const Selection all{{}, {0, 1}};
    const Analysis analysis = analyse(matrix, all);
    EXPECT_EQ(analysis.rank(), 2);
    EXPECT_EQ(analysis.independence.prime, internal::elimination_prime(k + 1));
    EXPECT_TRUE(verify(analysis, matrix, all));
    // Multipliers that are multiples of the primes themselves.
    const ConstraintMatrix dependent(2, {{{0, Rational(1)}, {1, Rational(1)}},
                                         {{0, p}, {1, Rational(1)}},
                                         {{0, Rational(1)}, {1, p}}});
    const Analysis circuit = analyse(dependent, all);
    EXPECT_EQ(circuit.rank(), 2);
    EXPECT_TRUE(verify(circuit, dependent, all));
    EXPECT_TRUE(verify_minimal(circuit.circuits[0], dependent, all.derived));
  }
}

// A long row takes the place of one whose multiplier is the prime itself.
TEST(Analysis, PrimesDoNotMisleadExchanges) {
  const int n = 40;
  const Rational p(Integer(static_cast<long>(internal::elimination_prime(0))));
  std::vector<RationalTerms> rows;
  for (int j = 0; j + 1 < n; ++j) rows.push_back(terms({{j, 1}, {j + 1, -1}}));
  RationalTerms sum{{0, p}, {1, Rational(1) - p}, {2, Rational(-1)}};  // p row 0 + row 1
  for (int j = 3; j + 1 < n; j += 2) {
    sum.emplace_back(j, Rational(1));
    sum.emplace_back(j + 1, Rational(-1));
  }
  rows.push_back(sum);
  const ConstraintMatrix matrix(n, rows);
  Selection all;
  for (int j = 0; j < n; ++j) all.derived.push_back(j);
  AnalysisOptions options;
  options.precedence.assign(rows.size(), 1);
  options.precedence[0] = 2;
  const Analysis analysis = analyse(matrix, all, options);
  EXPECT_THAT(analysis.dependent, ElementsAre(0));
  EXPECT_EQ(analysis.independence.prime, internal::elimination_prime(1));
  EXPECT_TRUE(verify(analysis, matrix, all));
}

TEST(Analysis, PrimesArePrime) {
  EXPECT_EQ(internal::elimination_prime(0), (1ul << 61) - 1);
  for (int k = 1; k < 4; ++k) {
    const unsigned long p = internal::elimination_prime(k);
    EXPECT_LT(p, internal::elimination_prime(k - 1));
    const internal::PrimeField field(p);
    for (const unsigned long a : {1ul, 2ul, 12345678901234567ul, p - 1}) {
      EXPECT_EQ(field.multiply(a, field.inverse(a)), 1u);
      EXPECT_EQ(field.multiply(a, field.factor(p - 2)), field.multiply(a, p - 2));
    }
    EXPECT_EQ(field.of(-5l), p - 5);
  }
}

}  // namespace
}  // namespace isochor
