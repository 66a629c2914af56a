#include "isochor/ecles/grid_editor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ecles/grid_chain.h"
#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::HasSubstr;
using Values = std::vector<std::vector<Rational>>;
using Outcome = GridUpdate::Outcome;

Rational fraction(long a, long b) { return Rational(Integer(a), Integer(b)); }

GridPlan start(GridEditor& editor, const Selection& selection, const GridOptions& options = {}) {
  return editor.initialize(selection, analyse(editor.matrix(), selection), options);
}

GridOptions with_policy(AnchorPolicy policy) {
  GridOptions options;
  options.policy = policy;
  return options;
}

// a + 2 b == 4 c, from (2, 1, 1), unit 1/8.
GridEditor small_editor() {
  return {ConstraintMatrix(3, {{{0, 1}, {1, 2}, {2, -4}}}), 1, 3, {{2, 1, 1}}};
}

TEST(GridEditor, RoundsTheOptimumToAnExactSolution) {
  GridEditor editor = small_editor();
  const GridPlan plan = start(editor, {{2}, {0, 1}});
  EXPECT_EQ(plan.blocks, 1);
  const GridUpdate update = editor.update({{fraction(9, 8)}}, {{2.0, 1.0}});
  ASSERT_EQ(update.outcome, Outcome::kDone) << update.reason;
  EXPECT_EQ(editor.value(0, 2), fraction(9, 8));
  EXPECT_TRUE(editor.row_value(0, 0).is_zero());
  // a + 2 b must grow by 4 units: the optimum moves (0.8, 1.6) units, the grid (0, 2).
  EXPECT_EQ(editor.number(0, 0), 16);
  EXPECT_EQ(editor.number(0, 1), 10);
  EXPECT_LE(update.distance, update.bound);
  EXPECT_GE(update.distance, 0.8 / 8 * (1 - 1e-12));
}

TEST(GridEditor, UpdatesStartFromTheBase) {
  GridEditor editor = small_editor();
  start(editor, {{2}, {0, 1}});
  editor.update({{Rational(5)}}, {{0.0, -3.0}});
  editor.update({{fraction(9, 8)}}, {{2.0, 1.0}});
  EXPECT_EQ(editor.number(0, 1), 10);
  editor.cancel();
  EXPECT_EQ(editor.value(0, 2), Rational(1));
  EXPECT_EQ(editor.value(0, 1), Rational(1));
}

TEST(GridEditor, AnchorsWithoutGridSolutionAreSnappedOrRefused) {
  // 4 a + 6 b == c: c moves by multiples of 2 units only.
  const std::vector<RationalTerms> rows = {{{0, 4}, {1, 6}, {2, -1}}};
  GridEditor editor(ConstraintMatrix(3, rows), 1, 0, {{1, 1, 10}});
  start(editor, {{2}, {0, 1}}, with_policy(AnchorPolicy::kSnap));
  GridUpdate update = editor.update({{17}}, {{1.0, 1.0}});
  ASSERT_EQ(update.outcome, Outcome::kDone);
  EXPECT_EQ(update.deviation, 1.0);
  EXPECT_EQ(update.anchors[0][0], editor.value(0, 2));
  EXPECT_EQ((editor.number(0, 2) - 17) * (editor.number(0, 2) - 17), 1);
  EXPECT_TRUE(editor.row_value(0, 0).is_zero());

  editor.cancel();
  start(editor, {{2}, {0, 1}}, with_policy(AnchorPolicy::kRequireExact));
  update = editor.update({{17}}, {{1.0, 1.0}});
  EXPECT_EQ(update.outcome, Outcome::kNoGridSolution);
  EXPECT_EQ(update.obstacle.rows, std::vector<int>{0});
  EXPECT_EQ(update.obstacle.multipliers, std::vector<Rational>{fraction(1, 2)});
  EXPECT_EQ(update.obstacle.value, fraction(7, 2));
  EXPECT_FALSE(update.obstacle.restricted);
  EXPECT_THAT(update.reason, HasSubstr("rows {0}"));
  EXPECT_THAT(update.reason, HasSubstr("2 divides"));
  EXPECT_EQ(editor.number(0, 2), 10);  // nothing changed
  EXPECT_EQ(editor.update({{18}}, {{1.0, 1.0}}).outcome, Outcome::kDone);
  EXPECT_EQ(editor.number(0, 2), 18);

  update = editor.update({{fraction(37, 2)}}, {{1.0, 1.0}});
  EXPECT_EQ(update.outcome, Outcome::kAnchorOffGrid);
  EXPECT_THAT(update.reason, HasSubstr("37/2"));
  EXPECT_EQ(editor.number(0, 2), 18);
}

TEST(GridEditor, RowsThatCannotFollowAreNamed) {
  const std::vector<RationalTerms> rows = {{{0, 1}, {1, 1}}, {{1, 1}, {2, 1}}};
  GridEditor editor(ConstraintMatrix(3, rows), 1, 0, {{0, 0, 0}});
  start(editor, {{0, 2}, {1}});
  const GridUpdate update = editor.update({{1, 2}}, {{0.0}});
  EXPECT_EQ(update.outcome, Outcome::kNotSolvable);
  EXPECT_THAT(update.reason, HasSubstr("row 1"));
  EXPECT_EQ(editor.number(0, 0), 0);
  EXPECT_EQ(editor.update({{2, 2}}, {{0.0}}).outcome, Outcome::kDone);  // weakly solvable
  EXPECT_EQ(editor.number(0, 1), -2);
}

TEST(GridEditor, NumbersThatLeave64BitsAreRefusedByValue) {
  const long near_limit = std::numeric_limits<long>::max() - 10;
  GridEditor editor(ConstraintMatrix(2, {{{0, 1}, {1, -1000}}}), 1, 0, {{near_limit, 0}});
  start(editor, {{1}, {0}});
  GridUpdate update = editor.update({{1}}, {{9e18}});
  EXPECT_EQ(update.outcome, Outcome::kTooLarge);
  EXPECT_THAT(update.reason, HasSubstr("9223372036854776797"));
  EXPECT_EQ(editor.number(0, 0), near_limit);
  update = editor.update({{Rational(1L << 60)}}, {{9e18}});
  EXPECT_EQ(update.outcome, Outcome::kTooLarge);
  EXPECT_THAT(update.reason, HasSubstr("2^53"));
}

TEST(GridEditor, RefusesValuesBesideTheGrid) {
  const ConstraintMatrix matrix(1, {});
  try {
    GridEditor(matrix, 3, 2, {{fraction(1, 5)}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("parameter 0: 1/5"));
    EXPECT_THAT(error.what(), HasSubstr("1/12"));
  }
  EXPECT_THROW(GridEditor(matrix, 1, 63, {{1}}), InputError);
  EXPECT_THROW(GridEditor(matrix, 0, 2, {{1}}), PreconditionError);
  EXPECT_THROW(GridEditor(matrix, 1, 2, {{1, 2}}), PreconditionError);
  GridEditor editor(matrix, 3, 2, {{fraction(1, 12)}});
  EXPECT_EQ(editor.number(0, 0), 1);
  EXPECT_THROW(editor.update({{}}, {{0.0}}), PreconditionError);
  start(editor, {{}, {0}});
  EXPECT_THROW(editor.update({{}}, {{}}), PreconditionError);
  EXPECT_THROW(editor.update({{}}, {{std::nan("")}}), PreconditionError);
  EXPECT_EQ(editor.update({{}}, {{1.0 / 3}}).outcome, Outcome::kDone);  // no row: rounds alone
  EXPECT_EQ(editor.number(0, 0), 4);
}

TEST(GridEditor, WeightsSayWhichParameterMovesLess) {
  for (const bool first_is_heavy : {false, true}) {
    GridEditor editor(ConstraintMatrix(3, {{{0, 1}, {1, 1}, {2, -1}}}), 1, 20, {{0, 0, 0}});
    GridOptions options;
    options.weights = {first_is_heavy ? 9 : 1, first_is_heavy ? 1 : 9};
    start(editor, {{2}, {0, 1}}, options);
    editor.update({{1}}, {{0.0, 0.0}});
    EXPECT_NEAR(editor.value(0, first_is_heavy ? 0 : 1).to_double(), 0.1, 1e-5);
  }
}

TEST(GridEditor, WeightsBeyondDoublesStillDecide) {
  // Both own columns of row 1 are heavier than doubles can say.
  const Rational huge = Rational(1).scaled_by_power_of_two(1200);
  const std::vector<RationalTerms> rows = {{{0, 1}, {1, 1}, {4, -1}}, {{2, 1}, {3, 1}, {4, -1}}};
  GridEditor editor(ConstraintMatrix(5, rows), 1, 20, {{0, 0, 0, 0, 0}});
  GridOptions options;
  options.weights = {1, huge, huge, huge};
  start(editor, {{4}, {0, 1, 2, 3}}, options);
  const GridUpdate update = editor.update({{1}}, {{0.0, 0.0, 0.0, 0.0}});
  ASSERT_EQ(update.outcome, Outcome::kDone) << update.reason;
  EXPECT_EQ(editor.value(0, 0), Rational(1));
  EXPECT_EQ(editor.value(0, 1), Rational(0));
  EXPECT_EQ(editor.value(0, 2), fraction(1, 2));
  expect_constraints(editor);
  options.weights[1] = 0;
  EXPECT_THROW(start(editor, {{4}, {0, 1, 2, 3}}, options), PreconditionError);
}

TEST(GridEditor, ComponentsTooLargeAreSolvedInRationals) {
  std::mt19937 random(kChainSeed);
  const testing::SplineEdits spline = testing::small_spline(3, kChainSeed);
  GridEditor editor = spline_editor(spline, 40);
  const Selection selection = spline_selection(spline, {7}, 2);
  GridOptions options;
  options.largest_block = 3;
  const GridPlan plan = start(editor, selection, options);
  ASSERT_FALSE(plan.loose.empty());
  const Values hints = derived_values(editor, selection);
  const Values targets = moved_anchors(editor, selection, fraction(3, 1));
  const GridUpdate update = editor.update(targets, rounded(hints));
  ASSERT_EQ(update.outcome, Outcome::kDone) << update.reason;
  expect_constraints(editor);
  bool any = false;
  for (const int j : plan.loose) any = any || !editor.rest(0, j).is_zero();
  EXPECT_TRUE(any);
  // The next edit, on lattices again, keeps the fractions and the rows.
  start(editor, selection);
  ASSERT_EQ(editor.update(targets, rounded(hints)).outcome, Outcome::kDone);
  expect_constraints(editor);
  editor.cancel();
  expect_constraints(editor);
}

TEST(GridEditor, BlocksThatRoundTooFarAreSolvedInRationals) {
  // 4095 a + 4094 b == c: the kernel is (4094, -4095), rounding ends up to 2047.5 units away.
  const std::vector<RationalTerms> rows = {{{0, 4095}, {1, 4094}, {2, -1}}};
  GridEditor editor(ConstraintMatrix(3, rows), 1, 10, {{0, 0, 0}});
  const Selection selection{{2}, {0, 1}};
  GridPlan plan = start(editor, selection);
  EXPECT_TRUE(plan.loose.empty());
  EXPECT_GT(plan.bound, 1.9);
  GridOptions options;
  options.largest_rounding = 1.0;
  plan = start(editor, selection, options);
  EXPECT_EQ(plan.loose, (std::vector<int>{0, 1}));
  EXPECT_EQ(plan.bound, 0.0);
  const GridUpdate update = editor.update({{1}}, {{0.0, 0.0}});
  ASSERT_EQ(update.outcome, Outcome::kDone) << update.reason;
  expect_constraints(editor);
  const long square = 4095L * 4095 + 4094L * 4094;
  EXPECT_EQ(editor.value(0, 0), fraction(4095, square));  // the optimum itself
  EXPECT_EQ(editor.value(0, 1), fraction(4094, square));
  EXPECT_LT(update.distance, 1e-12);
}

TEST(GridEditor, ChainsOfEditsStayExactAndWithinTheBound) {
  std::mt19937 random(kChainSeed);
  const testing::SplineEdits spline = testing::small_spline(4, kChainSeed);
  GridEditor editor = spline_editor(spline, 40);
  const ChainResult result = run_chain(editor, spline_chooser(spline), 60, 15, random);
  print(result, "quintic spline, 4 x 4 cells");
  EXPECT_EQ(result.edits, 60);
  EXPECT_EQ(result.sampled, 4);
  EXPECT_LE(result.largest_bits, 64u);
}

TEST(GridEditor, ChainsOnRandomSystemsStayExactAndWithinTheBound) {
  std::mt19937 random(kChainSeed + 1);
  const RandomGrid grid(160, 40, 4095, random);
  GridEditor editor = grid.editor(36);
  const ChainResult result = run_chain(editor, grid.chooser(), 100, 10, random);
  print(result, "random sparse system, 40 x 160");
  EXPECT_EQ(result.edits, 100);
  EXPECT_EQ(result.sampled, 10);
  EXPECT_LE(result.largest_bits, 64u);
}

TEST(GridEditor, RequiredAnchorsAreMetOrTheRefusalIsProven) {
  std::mt19937 random(kChainSeed + 2);
  const testing::SplineEdits spline = testing::small_spline(3, kChainSeed);
  GridEditor editor = spline_editor(spline, 40);
  int met = 0, refused = 0;
  std::uniform_int_distribution<long> step(-3, 3);
  for (int round = 0; round < 120; ++round) {
    const int anchor = static_cast<int>(random() % static_cast<unsigned>(spline.spline().points()));
    const Selection selection = spline_selection(spline, {anchor}, 0);
    const Analysis analysis = analyse(editor.matrix(), selection);
    if (!analysis.strongly_solvable()) continue;
    GridOptions options = with_policy(AnchorPolicy::kRequireExact);
    options.largest_block = 1000;  // nothing restricted: refusals are final
    EXPECT_FALSE(editor.initialize(selection, analysis, options).restricted);
    const Rational move = Rational(step(random)) * editor.unit();
    const GridUpdate update = editor.update(moved_anchors(editor, selection, move),
                                            rounded(derived_values(editor, selection)));
    if (update.outcome == Outcome::kDone) {
      ++met;
      EXPECT_EQ(update.deviation, 0.0);
      expect_constraints(editor);
      continue;
    }
    ASSERT_EQ(update.outcome, Outcome::kNoGridSolution) << update.reason;
    ++refused;
    expect_proof(editor.matrix(), selection, update.obstacle, move / editor.unit());
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace isochor
