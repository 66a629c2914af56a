// Ten thousand edits, each from the result of the one before.
#include <gtest/gtest.h>

#include <random>

#include "ecles/grid_chain.h"

namespace isochor {
namespace {

// The documented bound, relative to the domain: twelve-bit areas, unit 2^-40 / 5.
constexpr double kDocumentedShare = 0x1p-24;

TEST(GridEditorChain, TenThousandEditsOfASplineStayExactAndShort) {
  std::mt19937 random(kChainSeed);
  constexpr int kCells = 5, kSide = 40;
  const testing::SplineEdits spline = testing::small_spline(kCells, kChainSeed);
  GridEditor editor = spline_editor(spline, 40);
  unsigned long coefficient_bits = 0;
  for (int i = 0; i < editor.matrix().rows(); ++i)
    for (const ConstraintTerm& term : editor.matrix().row(i))
      coefficient_bits = std::max(coefficient_bits, term.coefficient.bits());
  EXPECT_EQ(coefficient_bits, 12u);
  const ChainResult result = run_chain(editor, spline_chooser(spline), 10000, 50, random);
  print(result, "quintic spline, 5 x 5 cells, coefficients of 12 bits");
  EXPECT_EQ(result.edits, 10000);
  EXPECT_EQ(result.sampled, 200);
  EXPECT_LE(result.largest_bits, 64u);
  EXPECT_LE(result.largest_distance, kDocumentedShare * kCells * kSide);
}

TEST(GridEditorChain, TenThousandEditsOfARandomSystemStayExactAndShort) {
  std::mt19937 random(kChainSeed + 1);
  const RandomGrid grid(160, 40, 4095, random);
  GridEditor editor = grid.editor(36);
  const ChainResult result = run_chain(editor, grid.chooser(), 10000, 50, random);
  print(result, "random sparse system, 40 x 160, coefficients of 12 bits");
  EXPECT_EQ(result.edits, 10000);
  EXPECT_EQ(result.sampled, 200);
  EXPECT_LE(result.largest_bits, 64u);
}

}  // namespace
}  // namespace isochor
