#include "isochor/ecles/proof.h"

#include <gtest/gtest.h>

#include <functional>

#include "ecles/random_systems.h"

namespace isochor {
namespace {

RationalTerms row(long a, long b, long c) {
  return {{0, Rational(a)}, {1, Rational(b)}, {2, Rational(c)}};
}

// Row 2 is row 0 + row 1, row 3 is on the anchor (parameter 3) alone.
ConstraintMatrix example() {
  std::vector<RationalTerms> rows{row(1, 2, 3), row(1, 0, 1), row(2, 2, 4), row(0, 0, 0)};
  rows[3].emplace_back(3, Rational(1));
  return ConstraintMatrix(5, rows);
}
const Selection kSelection{{3}, {0, 1, 2}};

TEST(Proof, AcceptsWhatIsProven) {
  const ConstraintMatrix matrix = example();
  const Analysis analysis = analyse(matrix, kSelection);
  ASSERT_EQ(analysis.circuits.size(), 2u);
  EXPECT_TRUE(verify(analysis, matrix, kSelection));
  for (const Circuit& circuit : analysis.circuits) {
    EXPECT_TRUE(verify_dependent(circuit, matrix, kSelection.derived));
    EXPECT_TRUE(verify_minimal(circuit, matrix, kSelection.derived));
  }
}

TEST(Proof, RefusesEveryTamperedAnalysis) {
  const ConstraintMatrix matrix = example();
  const std::vector<std::function<void(Analysis&)>> tampers{
      [](Analysis& a) { a.relevance.rows.pop_back(); },
      [](Analysis& a) { a.relevance.fixed.push_back(4); },
      [](Analysis& a) { a.independent.push_back(2); },
      [](Analysis& a) { a.independence.rows.pop_back(); },
      [](Analysis& a) { a.independence.rows[0] = a.independence.rows[1]; },
      [](Analysis& a) { a.independence.columns[0] = a.independence.columns[1]; },
      [](Analysis& a) { a.independence.columns[0] = 3; },
      [](Analysis& a) { a.independence.prime = 1; },
      [](Analysis& a) { a.independence.prime = 2; },  // the minor is even
      [](Analysis& a) { a.circuits[0].multipliers[0] += Integer(1); },
      [](Analysis& a) { a.circuits[0].multipliers.pop_back(); },
      [](Analysis& a) {
        a.circuits[0].rows = {0, 1};
      },
      [](Analysis& a) { std::swap(a.circuits[0], a.circuits[1]); },
      [](Analysis& a) { a.circuits.pop_back(); },
      [](Analysis& a) { a.dependent.pop_back(); },
      [](Analysis& a) { a.obstructions.clear(); },
      [](Analysis& a) {
        a.obstructions = {0, 1};
      },
      [](Analysis& a) {
        a.obstructions = {1, 2};
      },
      // A dependent row taken for an independent one and the reverse.
      [](Analysis& a) { std::swap(a.independence.rows[0], a.dependent[0]); },
  };
  for (size_t k = 0; k < tampers.size(); ++k) {
    Analysis analysis = analyse(matrix, kSelection);
    tampers[k](analysis);
    EXPECT_FALSE(verify(analysis, matrix, kSelection)) << "tamper " << k;
  }
}

TEST(Proof, AnInvertibleMinorNeedsNoPrime) {
  const ConstraintMatrix matrix(2, {{{0, Rational(3)}, {1, Rational(1)}},
                                    {{0, Rational(1)}, {1, Rational(2)}}});  // determinant 5
  for (const unsigned long modulus : {2ul, 4ul, 7ul, 1000000007ul, (1ul << 61) - 1}) {
    EXPECT_TRUE(verify(MinorProof{modulus, {0, 1}, {0, 1}}, matrix)) << modulus;
  }
  EXPECT_FALSE(verify(MinorProof{5, {0, 1}, {0, 1}}, matrix));
  EXPECT_FALSE(verify(MinorProof{0, {0, 1}, {0, 1}}, matrix));
  EXPECT_FALSE(verify(MinorProof{7, {0, 2}, {0, 1}}, matrix));
  EXPECT_FALSE(verify(MinorProof{7, {0, 1}, {0}}, matrix));
  EXPECT_TRUE(verify(MinorProof{7, {}, {}}, matrix));
}

TEST(Proof, MinimalityIsDecidedEvenForMultiplesOfPrimes) {
  // Two independent rows, dependent modulo many of the checker's own primes.
  Integer product(1);
  long prime = (1l << 31) + 11;
  for (int found = 0; found < 3; ++prime) {
    bool divided = false;
    for (long d = 2; d * d <= prime && !divided; ++d) divided = prime % d == 0;
    if (divided) continue;
    product *= Integer(prime);
    ++found;
  }
  const ConstraintMatrix matrix(2, {{{1, Rational(1)}},
                                    {{0, Rational(1)}, {1, Rational(1)}},
                                    {{0, Rational(1) + Rational(product)}, {1, Rational(1)}}});
  const Circuit circuit{{0, 1, 2}, {product, -Integer(1) - product, Integer(1)}};
  EXPECT_TRUE(verify_dependent(circuit, matrix, {0, 1}));
  EXPECT_TRUE(verify_minimal(circuit, matrix, {0, 1}));
  const ConstraintMatrix twice(2, {{{1, Rational(1)}}, {{0, Rational(1)}}, {{0, Rational(2)}}});
  EXPECT_FALSE(verify_minimal({{0, 1, 2}, {}}, twice, {0, 1}));
}

TEST(Proof, RefusesCircuitsThatAreNone) {
  const ConstraintMatrix matrix = example();
  const auto refused = [&](const Circuit& circuit) {
    return !verify_dependent(circuit, matrix, kSelection.derived);
  };
  EXPECT_TRUE(refused({{}, {}}));
  EXPECT_TRUE(refused({{0}, {Integer(0)}}));
  EXPECT_TRUE(refused({{0, 1}, {Integer(1), Integer(-1)}}));
  EXPECT_TRUE(refused({{1, 0}, {Integer(1), Integer(1)}}));
  EXPECT_TRUE(refused({{4}, {Integer(1)}}));
  EXPECT_FALSE(refused({{3}, {Integer(1)}}));
}

}  // namespace
}  // namespace isochor
