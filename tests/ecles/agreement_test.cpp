// The sparse engine against the thesis' dense one: two implementations that share nothing but the
// matrix must give the same verdicts and the same solutions, to the last digit.

#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "ecles/random_edits.h"
#include "isochor/ecles/analysis.h"
#include "isochor/ecles/conflicts.h"
#include "isochor/ecles/least_change.h"
#include "isochor/ecles/reference.h"

namespace isochor {
namespace {

using test::System;

std::vector<Rational> column(const RationalMatrix& matrix, int c) {
  std::vector<Rational> result;
  for (int i = 0; i < matrix.rows(); ++i) result.push_back(matrix.at(i, c));
  return result;
}

struct Seen {
  int conflicting = 0;
  int solved = 0;
};

void expect_agreement(std::mt19937_64& random, const System& system, bool anchors_move,
                      Seen& seen) {
  const ConstraintMatrix matrix(system.parameters, test::terms_of(system.rows));
  const ReferenceEditor reference(matrix, system.right, system.values, system.selection);
  const Analysis analysis = analyse(matrix, system.selection);
  EXPECT_EQ(analysis.relevance.rows, reference.relevance().rows);
  EXPECT_EQ(analysis.rank(), reference.rank());
  EXPECT_EQ(analysis.dependent.size(), reference.redundant().size());
  EXPECT_EQ(analysis.strongly_solvable(), reference.strongly_solvable());

  const auto anchors = static_cast<int>(system.selection.anchors.size());
  const auto derived = static_cast<int>(system.selection.derived.size());
  const RationalMatrix hints = test::random_values(random, derived, system.components);
  RationalMatrix target = test::random_values(random, anchors, system.components);
  RationalMatrix state = system.values;
  for (int c = 0; c < system.components; ++c) {
    for (int k = 0; k < anchors; ++k) {
      const int parameter = system.selection.anchors[static_cast<size_t>(k)];
      if (!anchors_move || random() % 2 == 0) target.set(k, c, system.values.at(parameter, c));
      state.set(parameter, c, target.at(k, c));
    }
    for (int s = 0; s < derived; ++s) {
      state.set(system.selection.derived[static_cast<size_t>(s)], c, hints.at(s, c));
    }
  }
  std::vector<std::vector<Rational>> rights, values;
  for (int c = 0; c < system.components; ++c) {
    rights.push_back(column(system.right, c));
    values.push_back(column(state, c));
  }
  std::vector<Rational> weights;
  for (int s = 0; s < derived; ++s) weights.emplace_back(1 + static_cast<long>(random() % 9), 4);

  const auto expected = reference.update(target, hints, weights);
  const bool conflict = !conflicts(matrix, analysis, rights, values).empty();
  EXPECT_EQ(conflict, !expected.has_value());
  if (!expected) {
    ++seen.conflicting;
    return;
  }
  ++seen.solved;
  const LeastChange least(matrix, system.selection.derived, analysis.independent, weights);
  for (int c = 0; c < system.components; ++c) {
    EXPECT_EQ(least.solve(rights[static_cast<size_t>(c)], values[static_cast<size_t>(c)]),
              column(expected->derived, c));
  }
}

TEST(Agreement, SparseAndDenseEnginesGiveTheSame) {
  constexpr unsigned long kSeed = 61;
  std::mt19937_64 random(kSeed);
  Seen seen;
  for (int round = 0; round < 300; ++round) {
    const int rows = static_cast<int>(random() % 14);
    const int columns = static_cast<int>(random() % 20);
    const int rank = round % 3 == 0 ? static_cast<int>(random() % 8) : -1;
    const double density = round % 2 == 0 ? 0.2 : 0.6;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed << ", round " << round);
    expect_agreement(
        random,
        test::random_system(random, {rows, columns, rank, density, 4},
                            static_cast<test::Size>(round % 4), static_cast<int>(random() % 3)),
        true, seen);
  }
  std::cout << "seed " << kSeed << ": solved " << seen.solved << ", conflicting "
            << seen.conflicting << "\n";
  EXPECT_GT(seen.solved, 50);
  EXPECT_GT(seen.conflicting, 50);
}

TEST(Agreement, LargerSystems) {
  unsigned long seed = 6200;
  Seen seen;
  for (const test::RandomMatrix& wanted :
       {test::RandomMatrix{60, 60, -1, 0.04, 10}, test::RandomMatrix{40, 60, 25, 0.15, 3},
        test::RandomMatrix{60, 40, 20, 0.1, 3}, test::RandomMatrix{30, 50, -1, 1.0, 6}}) {
    for (const test::Size size : {test::Size::kPlain, test::Size::kTiny}) {
      std::mt19937_64 random(++seed);
      SCOPED_TRACE(::testing::Message() << "seed " << seed);
      const System system = test::random_system(random, wanted, size, 1);
      expect_agreement(random, system, true, seen);
      expect_agreement(random, system, false, seen);
    }
  }
  std::cout << "solved " << seen.solved << ", conflicting " << seen.conflicting << "\n";
  EXPECT_GE(seen.solved, 4);
  EXPECT_GE(seen.conflicting, 4);
}

}  // namespace
}  // namespace isochor
