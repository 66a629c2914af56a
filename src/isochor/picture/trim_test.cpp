#include "isochor/picture/trim_test.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/tolerance.h"

namespace isochor::internal {
namespace {

constexpr int kMaxRows = 512;

}  // namespace

TrimTest::TrimTest(const TrimRegion& trim, const UvBox& domain) : domain_(domain) {
  u_margin_ = kCoincident * (domain.u_max - domain.u_min);
  v_margin_ = kCoincident * (domain.v_max - domain.v_min);
  for (const std::vector<Uv>& loop : trim.loops) {
    for (size_t i = 0; i < loop.size(); ++i) {
      const Uv& a = loop[i];
      const Uv& b = loop[(i + 1) % loop.size()];
      if (!(a == b)) segments_.push_back({a, b});
    }
  }
  rows_.resize(std::clamp<size_t>(segments_.size(), 1, kMaxRows));
  for (size_t k = 0; k < segments_.size(); ++k) {
    const auto [low, high] = std::minmax(segments_[k].a.v, segments_[k].b.v);
    for (int row = row_of(low); row <= row_of(high); ++row) {
      rows_[static_cast<size_t>(row)].push_back(static_cast<int>(k));
    }
  }
}

int TrimTest::row_of(double v) const {
  const double fraction = (v - domain_.v_min) / (domain_.v_max - domain_.v_min);
  const auto count = static_cast<int>(rows_.size());
  return std::clamp(static_cast<int>(std::floor(std::clamp(fraction, -1.0, 2.0) * count)), 0,
                    count - 1);
}

bool TrimTest::inside(double u, double v) const {
  if (keeps_all()) return true;
  u = std::clamp(u, domain_.u_min + u_margin_, domain_.u_max - u_margin_);
  v = std::clamp(v, domain_.v_min + v_margin_, domain_.v_max - v_margin_);
  bool odd = false;
  for (int k : rows_[static_cast<size_t>(row_of(v))]) {
    const auto& [a, b] = segments_[static_cast<size_t>(k)];
    if ((a.v <= v) == (b.v <= v)) continue;
    if (a.u + (b.u - a.u) * ((v - a.v) / (b.v - a.v)) > u) odd = !odd;
  }
  return odd;
}

bool TrimTest::crosses(const UvBox& box) const {
  if (keeps_all()) return false;
  const double u0 = box.u_min + u_margin_, u1 = box.u_max - u_margin_;
  const double v0 = box.v_min + v_margin_, v1 = box.v_max - v_margin_;
  for (int row = row_of(v0); row <= row_of(v1); ++row) {
    for (int k : rows_[static_cast<size_t>(row)]) {
      const auto& [a, b] = segments_[static_cast<size_t>(k)];
      if (std::max(a.u, b.u) < u0 || std::min(a.u, b.u) > u1) continue;
      if (std::max(a.v, b.v) < v0 || std::min(a.v, b.v) > v1) continue;
      // The box is missed when all its corners lie on one side of the segment's line.
      const double du = b.u - a.u, dv = b.v - a.v;
      const Uv start = a;  // C++17 lambdas cannot capture a structured binding
      const auto side = [=](double u, double v) { return du * (v - start.v) - dv * (u - start.u); };
      const double s[4] = {side(u0, v0), side(u1, v0), side(u1, v1), side(u0, v1)};
      const auto [low, high] = std::minmax_element(s, s + 4);
      if (*low <= 0.0 && *high >= 0.0) return true;
    }
  }
  return false;
}

}  // namespace isochor::internal
