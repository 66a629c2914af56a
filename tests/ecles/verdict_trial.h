// Many random systems: every verdict against elimination over the rationals, every certificate
// through the checker, and beside it what a floating QR would have said.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <iostream>

#include "ecles/random_systems.h"
#include "isochor/ecles/conflicts.h"
#include "isochor/ecles/proof.h"

namespace isochor::testing {

struct TrialCounts {
  int systems = 0, dependent = 0, conflicting = 0, not_solvable = 0;
  int floating_wrong = 0;
};

// The rank by Householder QR with column pivoting, rows scaled to length 1, threshold 1e-12.
inline int floating_rank(const ConstraintMatrix& matrix, const std::vector<int>& rows,
                         const std::vector<int>& derived) {
  Eigen::MatrixXd dense(static_cast<Eigen::Index>(rows.size()),
                        static_cast<Eigen::Index>(derived.size()));
  for (Eigen::Index i = 0; i < dense.rows(); ++i) {
    const RationalRow row = restricted(matrix, rows[static_cast<size_t>(i)], derived);
    for (Eigen::Index j = 0; j < dense.cols(); ++j) {
      dense(i, j) = row[static_cast<size_t>(j)].to_double();
    }
    const double length = dense.row(i).stableNorm();
    if (length > 0.0) dense.row(i) /= length;
  }
  if (dense.size() == 0) return 0;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
  qr.setThreshold(1e-12);
  return static_cast<int>(qr.compute(dense).rank());
}

inline Rational row_at(const RationalTerms& row, const RationalRow& point) {
  Rational sum;
  for (const auto& [parameter, a] : row) sum += a * point[static_cast<size_t>(parameter)];
  return sum;
}

// Right-hand sides that `point` meets, one of them changed or none.
inline void judge_conflicts(const RandomSystem& system, const ConstraintMatrix& matrix,
                            const Analysis& analysis, SystemGenerator& generator,
                            TrialCounts& counts) {
  RationalRow right_side;
  for (const RationalTerms& row : system.rows) right_side.push_back(row_at(row, system.solution));
  if (!right_side.empty() && generator.number(0, 1) == 0) {
    const int i = generator.number(0, static_cast<int>(right_side.size()) - 1);
    right_side[static_cast<size_t>(i)] += Rational(Integer(1), Integer(1000000007));
  }
  RationalEchelon plain, augmented;
  for (const int i : analysis.relevance.rows) {
    RationalRow row = restricted(matrix, i, system.selection.derived);
    plain.insert(row);
    Rational rest = right_side[static_cast<size_t>(i)];
    rest -= row_at(system.rows[static_cast<size_t>(i)], system.solution);
    row.push_back(rest);
    augmented.insert(row);
  }
  RationalRow values = system.solution;
  for (const int j : system.selection.derived) values[static_cast<size_t>(j)] = Rational(12345);
  const std::vector<std::vector<Rational>> right_sides{right_side}, all_values{values};
  const std::vector<Conflict> found = conflicts(matrix, analysis, right_sides, all_values);
  ASSERT_EQ(found.empty(), plain.rank() == augmented.rank());
  counts.conflicting += found.empty() ? 0 : 1;
  for (const Conflict& conflict : found) {
    ASSERT_TRUE(verify_conflict(analysis.circuits[static_cast<size_t>(conflict.circuit)], conflict,
                                matrix, system.selection, right_sides, all_values));
  }
}

inline void judge(const RandomSystem& system, SystemGenerator& generator, TrialCounts& counts) {
  const ConstraintMatrix matrix(system.parameters, system.rows);
  const Selection& selection = system.selection;
  AnalysisOptions options;
  options.precedence = system.precedence;
  const Analysis analysis = analyse(matrix, selection, options);
  const std::vector<int>& rows = analysis.relevance.rows;
  ++counts.systems;
  ASSERT_TRUE(verify(analysis, matrix, selection));
  ASSERT_EQ(analysis.independent, first_basis(matrix, rows, selection.derived, system.precedence));
  std::vector<int> both = selection.derived;
  both.insert(both.end(), selection.anchors.begin(), selection.anchors.end());
  ASSERT_EQ(analysis.strongly_solvable(), rational_rank(matrix, rows, both) == analysis.rank());
  for (const Circuit& circuit : analysis.circuits) {
    ASSERT_TRUE(verify_minimal(circuit, matrix, selection.derived));
    Integer content;
    for (const Integer& y : circuit.multipliers) content = gcd(content, y);
    ASSERT_EQ(content, Integer(1));
    ASSERT_GT(circuit.multipliers.front().sign(), 0);
  }
  counts.dependent += analysis.circuits.empty() ? 0 : 1;
  counts.not_solvable += analysis.strongly_solvable() ? 0 : 1;
  counts.floating_wrong +=
      floating_rank(matrix, rows, selection.derived) == analysis.rank() ? 0 : 1;
  judge_conflicts(system, matrix, analysis, generator, counts);
}

inline void expect_all_right(int systems, unsigned seed) {
  SystemGenerator generator(seed);
  TrialCounts counts;
  for (int i = 0; i < systems; ++i) {
    const auto kind = static_cast<SystemKind>(i % kSystemKinds);
    const int largest = i % 100 < 93 ? 10 : (i % 100 < 99 ? 25 : 40);
    const RandomSystem system = generator.next(kind, largest);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", system " << i);
    judge(system, generator, counts);
    if (::testing::Test::HasFatalFailure()) return;
  }
  std::cout << counts.systems << " systems (seed " << seed << "), exact: 0 wrong; "
            << counts.dependent << " with dependent rows, " << counts.conflicting
            << " conflicting, " << counts.not_solvable << " not strongly solvable\n"
            << "floating QR, threshold 1e-12: " << counts.floating_wrong << " wrong ranks\n";
  EXPECT_GT(counts.dependent, systems / 4);
  EXPECT_GT(counts.conflicting, systems / 20);
  EXPECT_GT(counts.not_solvable, systems / 20);
  EXPECT_GT(counts.floating_wrong, 0);
}

}  // namespace isochor::testing
