#include "isochor/ecles/lattice_blocks.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/least_change.h"
#include "support/spline_edits.h"

namespace isochor::internal {
namespace {

constexpr int kSeed = 20170411;

struct Case {
  ConstraintMatrix matrix;
  Selection selection;
  std::vector<int> independent;
};

// Rows of up to five neighbouring parameters; the first two parameters of each window are anchors.
Case random_case(int parameters, int rows, long size, std::mt19937& random) {
  for (;;) {
    std::uniform_int_distribution<long> entry(-size, size);
    std::vector<RationalTerms> terms(static_cast<size_t>(rows));
    for (auto& row : terms) {
      const int first = static_cast<int>(random() % static_cast<unsigned>(parameters - 5));
      for (int k = 0; k < 5; ++k)
        if (random() % 4 != 0) row.emplace_back(first + k, Rational(entry(random)));
    }
    Case result{ConstraintMatrix(parameters, terms), {}, {}};
    for (int j = 0; j < parameters; ++j)
      (j % 17 == 3 ? result.selection.anchors : result.selection.derived).push_back(j);
    const Analysis analysis = analyse(result.matrix, result.selection);
    if (!analysis.strongly_solvable()) continue;
    result.independent = analysis.independent;
    return result;
  }
}

Case spline_case(const testing::SplineEdits& spline, int anchor) {
  Case result{
      ConstraintMatrix(spline.spline().points(), spline.spline().rows()), {{anchor}, {}}, {}};
  result.selection.derived = spline.derived({anchor}, spline.neighbourhood({anchor}, 1));
  result.independent = analyse(result.matrix, result.selection).independent;
  return result;
}

std::vector<Case> cases() {
  std::mt19937 random(kSeed);
  std::vector<Case> result;
  for (int k = 0; k < 12; ++k) result.push_back(random_case(20 + 4 * k, 5 + k, 40, random));
  const testing::SplineEdits spline = testing::small_spline(3, kSeed);
  for (const int anchor : {0, 20, 40}) result.push_back(spline_case(spline, anchor));
  return result;
}

LatticeBlocks divide(const Case& given, int columns, LatticeCache& cache) {
  LatticeLimits limits;
  limits.columns = columns;
  return {given.matrix, given.selection, given.independent, {}, limits, cache};
}

TEST(LatticeBlocks, CoverEachRowAndParameterOnce) {
  size_t loose = 0, peeled = 0, restricted = 0;
  for (const Case& given : cases())
    for (const int columns : {64, 12, 4}) {
      LatticeCache cache;
      const LatticeBlocks blocks = divide(given, columns, cache);
      std::vector<int> rows = blocks.loose_rows(), positions = blocks.loose();
      positions.insert(positions.end(), blocks.free().begin(), blocks.free().end());
      for (const LatticeBlock& block : blocks.blocks()) {
        rows.insert(rows.end(), block.rows.begin(), block.rows.end());
        positions.insert(positions.end(), block.columns.begin(), block.columns.end());
        EXPECT_TRUE(block.peeled || block.columns.size() <= static_cast<size_t>(columns));
        peeled += block.peeled ? 1 : 0;
      }
      std::sort(rows.begin(), rows.end());
      std::sort(positions.begin(), positions.end());
      EXPECT_EQ(rows, given.independent);
      ASSERT_EQ(positions.size(), given.selection.derived.size());
      for (size_t k = 0; k < positions.size(); ++k) EXPECT_EQ(positions[k], static_cast<int>(k));
      loose += blocks.loose().size();
      restricted += blocks.restricted() ? 1 : 0;
    }
  EXPECT_GT(loose, 0u);
  EXPECT_GT(peeled, 0u);
  EXPECT_GT(restricted, 0u);
}

TEST(LatticeBlocks, NearestIsExactAndWithinTheBound) {
  std::mt19937 random(kSeed + 1);
  std::uniform_real_distribution<double> share(-1.0, 1.0);
  int tried = 0;
  for (const Case& given : cases())
    for (const int columns : {64, 12}) {
      LatticeCache cache;
      const LatticeBlocks blocks = divide(given, columns, cache);
      if (!blocks.loose().empty()) continue;
      const auto& [anchors, derived] = given.selection;
      std::vector<long> wanted;
      for (size_t k = 0; k < anchors.size(); ++k)
        wanted.push_back(static_cast<long>(share(random) * 0x1p40));
      std::vector<Wide> z, x;
      ASSERT_TRUE(blocks.anchors().nearest(wanted, z));
      std::vector<double> values(static_cast<size_t>(given.matrix.parameters()));
      for (const int j : derived) values[static_cast<size_t>(j)] = share(random) * 0x1p40;
      for (size_t k = 0; k < anchors.size(); ++k)
        values[static_cast<size_t>(anchors[k])] = static_cast<double>(z[k]);
      const LeastChange least(given.matrix, derived, given.independent);
      const auto target =
          least.approximate(std::vector<double>(static_cast<size_t>(given.matrix.rows())), values);
      ASSERT_TRUE(blocks.nearest(z, target.derived, x));
      for (size_t k = 0; k < x.size(); ++k)
        EXPECT_LE(std::fabs(static_cast<double>(x[k]) - target.derived[k]),
                  blocks.bound()[k] + 2 * target.last_change + 0.01)
            << k;
      std::vector<Wide> numbers(values.size());
      for (size_t k = 0; k < anchors.size(); ++k) numbers[static_cast<size_t>(anchors[k])] = z[k];
      for (size_t k = 0; k < derived.size(); ++k) numbers[static_cast<size_t>(derived[k])] = x[k];
      for (int i = 0; i < given.matrix.rows(); ++i) {  // the dependent rows follow
        Wide sum = 0;
        for (const ConstraintTerm& term : given.matrix.row(i))
          ASSERT_TRUE(add_product(sum, numbers[static_cast<size_t>(term.parameter)],
                                  *term.coefficient.to_long()));
        EXPECT_TRUE(sum == 0) << "row " << i;
      }
      ++tried;
    }
  EXPECT_GT(tried, 12);
}

// Whether A x = s has an integer solution: s lies in the lattice of A's columns exactly when it
// does not make that lattice finer. Independent of the code under test.
bool solvable_over_integers(const Case& given, const std::vector<Integer>& z) {
  const auto m = static_cast<int>(given.independent.size());
  const auto n = static_cast<int>(given.selection.derived.size());
  IntegerMatrix columns(n, m), extended(n + 1, m);
  for (int i = 0; i < m; ++i)
    for (const ConstraintTerm& term : given.matrix.row(given.independent[static_cast<size_t>(i)])) {
      for (int k = 0; k < n; ++k)
        if (given.selection.derived[static_cast<size_t>(k)] == term.parameter) {
          columns.set(k, i, term.coefficient);
          extended.set(k, i, term.coefficient);
        }
      for (size_t k = 0; k < z.size(); ++k)
        if (given.selection.anchors[k] == term.parameter)
          extended.at(n, i).add_product(term.coefficient, z[k]);
    }
  const IntegerMatrix a = columns.hermite_form().form, b = extended.hermite_form().form;
  for (int i = 0; i < m; ++i)
    if (a.at(i, i) != b.at(i, i)) return false;
  return true;
}

TEST(LatticeBlocks, AnchorsMayMoveExactlyWhereTheIntegersHaveASolution) {
  std::mt19937 random(kSeed + 2);
  int solvable = 0, refused = 0;
  for (int round = 0; round < 300; ++round) {
    const Case given = random_case(18, 7, 6, random);
    LatticeCache cache;
    const LatticeBlocks blocks = divide(given, 64, cache);
    ASSERT_TRUE(blocks.loose().empty());
    ASSERT_FALSE(blocks.restricted());
    std::vector<long> wanted;
    std::vector<Integer> z;
    for (size_t k = 0; k < given.selection.anchors.size(); ++k) {
      wanted.push_back(std::uniform_int_distribution<long>(-30, 30)(random));
      z.emplace_back(wanted.back());
    }
    std::vector<Wide> used, x;
    ASSERT_TRUE(blocks.anchors().nearest(wanted, used));
    const bool kept = std::equal(used.begin(), used.end(), wanted.begin());
    EXPECT_EQ(kept, solvable_over_integers(given, z));
    EXPECT_EQ(kept, !blocks.obstacle(z));
    ++(kept ? solvable : refused);
    // Snapped or not, the move has a solution.
    EXPECT_TRUE(blocks.nearest(used, std::vector<double>(given.selection.derived.size()), x));
  }
  EXPECT_GT(solvable, 50);
  EXPECT_GT(refused, 50);
}

TEST(LatticeBlocks, DivisionRestrictsColumnsToMultiples) {
  // Row 0 owns a (4) and meets c, row 1 owns b (6) and meets c: 4 a + c == 0, 6 b + c == 0.
  const ConstraintMatrix matrix(4, {{{0, 4}, {2, 1}}, {{1, 6}, {2, 1}, {3, 1}}});
  const Selection selection{{3}, {0, 1, 2}};
  LatticeCache cache;
  const LatticeBlocks whole(matrix, selection, {0, 1}, {}, {}, cache);
  EXPECT_FALSE(whole.restricted());
  EXPECT_EQ(whole.blocks().size(), 1u);
  LatticeLimits limits;
  limits.columns = 2;
  const LatticeBlocks divided(matrix, selection, {0, 1}, {}, limits, cache);
  EXPECT_TRUE(divided.restricted());
  EXPECT_EQ(divided.blocks().size(), 2u);
  EXPECT_EQ(divided.free(), std::vector<int>{2});
  EXPECT_EQ(divided.bound()[2], 6.0);  // multiples of 12
  // The anchor may move by 2 in the integers (a = 1, c = -4, 6 b = 2 is wrong; c = 4, b = -1 is
  // right); divided, only by 6.
  EXPECT_FALSE(whole.obstacle({2}));
  const auto obstacle = divided.obstacle({2});
  ASSERT_TRUE(obstacle);
  EXPECT_TRUE(obstacle->restricted);
  EXPECT_EQ(obstacle->rows, std::vector<int>{1});
  EXPECT_FALSE(divided.obstacle({6}));
  std::vector<Wide> x;
  ASSERT_TRUE(divided.nearest({6}, {0.0, -1.0, 3.0}, x));
  EXPECT_TRUE(4 * x[0] + x[2] == 0 && 6 * x[1] + x[2] + 6 == 0);
}

TEST(LatticeBlocks, NothingDerived) {
  const ConstraintMatrix matrix(2, {{{0, Rational(1)}}});
  LatticeCache cache;
  const LatticeBlocks blocks(matrix, {{1}, {}}, {}, {}, {}, cache);
  std::vector<Wide> x;
  EXPECT_TRUE(blocks.nearest({5}, {}, x));
  EXPECT_TRUE(x.empty());
  EXPECT_FALSE(blocks.obstacle({5}));
}

}  // namespace
}  // namespace isochor::internal
