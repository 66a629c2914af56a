#include "isochor/step/bytes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "isochor/step/model_bytes.h"

namespace isochor {
namespace {

using internal::BytesError;
using internal::from_bytes;
using internal::to_bytes;

template <typename T>
T there_and_back(const T& value) {
  return from_bytes<T>(to_bytes(value));
}

TEST(Bytes, NumbersKeepTheirBits) {
  for (double x : {0.0, -0.0, 0.1, std::numeric_limits<double>::denorm_min(),
                   std::numeric_limits<double>::infinity()}) {
    const double y = there_and_back(x);
    EXPECT_EQ(std::memcmp(&x, &y, sizeof x), 0) << x;
  }
  EXPECT_TRUE(std::isnan(there_and_back(std::nan("7"))));
  EXPECT_EQ(there_and_back(-7), -7);
  EXPECT_EQ(there_and_back(true), true);
  EXPECT_EQ(there_and_back(Smoothness::kTangent), Smoothness::kTangent);
}

TEST(Bytes, ContainersKeepTheirContent) {
  const std::vector<std::string> names = {"", "a", std::string("nul\0inside", 10)};
  EXPECT_EQ(there_and_back(names), names);
  const std::vector<std::pair<int, int>> pairs = {{1, 2}, {3, -4}};
  EXPECT_EQ(there_and_back(pairs), pairs);
  const std::array<bool, 4> flags = {true, false, false, true};
  EXPECT_EQ(there_and_back(flags), flags);
  EXPECT_EQ(there_and_back(std::optional<int>()), std::nullopt);
  EXPECT_EQ(there_and_back(std::optional<int>(3)), 3);
  const std::vector<std::vector<Uv>> loops = {{{1, 2}, {3, 4}}, {}};
  EXPECT_EQ(there_and_back(loops), loops);
  EXPECT_EQ(there_and_back(std::vector<Vec3>{{1, 2, 3}}), (std::vector<Vec3>{{1, 2, 3}}));
}

TEST(Bytes, SurfacesKeepKnotsPolesAndWeights) {
  const auto u = KnotVector::clamped(2, {0.0, 0.1, 1.0});
  const auto v = KnotVector::uniform(1, 1);
  std::vector<Vec3> poles;
  std::vector<double> weights;
  for (int k = 0; k < u.size() * v.size(); ++k) {
    poles.emplace_back(0.1 * k, 1.0 / (k + 3), -k);
    weights.push_back(1.0 + 0.1 * k);
  }
  const auto back = there_and_back(Surface(u, v, poles, weights));
  EXPECT_EQ(back.u_knots(), u);
  EXPECT_EQ(back.v_knots(), v);
  EXPECT_EQ(back.poles(), poles);
  EXPECT_EQ(back.weights(), weights);
}

SolidModel example_model() {
  SolidModel model;
  model.path = "wing.step";
  model.unit = "inch";
  model.patches.points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0.5}};
  const auto line = KnotVector::uniform(1, 1);
  Patch patch{"skin", "face:1", line, line, {0, 1, 2, 3}, {}, true, {"#17"}, {}};
  patch.trim.boundary = {{0, 1, 0, 0.5}};
  model.patches.patches = {patch};
  Join join;
  join.b.side = Side::kVEnd;
  join.mismatch = "other knots";
  model.patches.joins = {join};
  model.patches.locked_sides = {{{0, Side::kUEnd}, "face:2", Smoothness::kAlmost}};
  model.patches.lock(2, "edge", true);
  model.patches.lock_reasons.back().join = 0;
  SmoothRelation relation;
  relation.join = 0;
  relation.lambda = Rational(Integer(3), Integer(4));
  relation.text = "meets itself";
  relation.sides = {join.a, join.b};
  relation.equations = {{{{1, 2, Rational(Integer(-5), Integer(7))}}}};
  model.patches.relations = {relation};
  FaceFacts face;
  face.handle = "face:1";
  face.flux = 0.25;
  face.trim = TrimKind::kTrimmedWithHoles;
  model.faces = {face};
  EdgeFacts edge;
  edge.faces = {0, 0};
  edge.max_gap = 1e-9;
  model.edges = {edge};
  model.facts.names = {"wing", "skin"};
  model.facts.closed = true;
  model.notices = {"repaired"};
  return model;
}

TEST(Bytes, SolidModelsKeepEveryField) {
  const auto model = example_model();
  const auto back = there_and_back(model);
  // Equal bytes mean equal fields, because every field was listed above at least by its struct.
  EXPECT_EQ(to_bytes(back), to_bytes(model));
  EXPECT_EQ(back.unit, "inch");
  ASSERT_EQ(back.patches.patches.size(), 1u);
  EXPECT_EQ(back.patches.patches[0].handle, "face:1");
  EXPECT_TRUE(back.patches.patches[0].reversed);
  EXPECT_EQ(back.patches.patches[0].trim.boundary.at(0).v_max, 0.5);
  EXPECT_EQ(back.patches.joins.at(0).mismatch, "other knots");
  EXPECT_EQ(back.patches.locks.size(), 1u);
  EXPECT_EQ(back.patches.lock_reasons.at(0).join, 0);
  ASSERT_EQ(back.patches.relations.size(), 1u) << "or edits of solids would crease";
  const SmoothRelation& relation = back.patches.relations[0];
  EXPECT_EQ(relation.lambda.to_string(), "3/4");
  EXPECT_EQ(relation.text, "meets itself");
  EXPECT_EQ(relation.sides.size(), 2u);
  EXPECT_EQ(relation.equations.at(0).at(0).at(0).row, 2);
  EXPECT_EQ(relation.equations.at(0).at(0).at(0).value.to_string(), "-5/7");
  EXPECT_EQ(back.faces.at(0).flux, 0.25);
  EXPECT_EQ(back.edges.at(0).faces, (std::vector<int>{0, 0}));
  EXPECT_TRUE(back.facts.closed);
  EXPECT_EQ(back.notices, model.notices);
}

TEST(Bytes, RationalsKeepTheirValue) {
  for (const char* text : {"0", "-3/2", "0.1", "9223372036854775807/2", "9223372036854775808/3",
                           "-7/9223372036854775809", "1e40"}) {
    const Rational value = Rational::parse(text);
    EXPECT_EQ(there_and_back(value), value) << text;
  }
  internal::ByteWriter damaged;
  damaged(true, 1L, 0L);
  EXPECT_THROW(from_bytes<Rational>(damaged.take()), BytesError);
}

TEST(Bytes, EveryTruncationIsRefused) {
  const std::string bytes = to_bytes(example_model());
  for (size_t size = 0; size < bytes.size(); size += 7) {
    EXPECT_THROW(from_bytes<SolidModel>(bytes.substr(0, size)), BytesError) << size;
  }
}

TEST(Bytes, ADamagedLengthDoesNotAllocate) {
  std::string bytes = to_bytes(std::vector<double>{1, 2});
  bytes[7] = '\x7f';  // the length becomes about 10^19
  EXPECT_THROW(from_bytes<std::vector<double>>(bytes), BytesError);
  EXPECT_THROW(from_bytes<std::string>(bytes), BytesError);
}

}  // namespace
}  // namespace isochor
