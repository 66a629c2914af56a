#include "isochor/multires/two_scale.h"

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "isochor/base/error.h"

namespace isochor {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

// The knots of `fine` without the interior values for which `removed` says so.
template <typename Removed>
KnotVector without(const KnotVector& fine, Removed removed) {
  std::vector<double> knots;
  for (double t : fine.knots()) {
    const bool interior = fine.begin() < t && t < fine.end();
    if (!interior || !removed(t)) knots.push_back(t);
  }
  return KnotVector(fine.degree(), std::move(knots));
}

// Wrapped: the knots beyond the ends must follow. Start from the period alone (no interior knots),
// whose extension is then rebuilt by inserting the kept ones.
KnotVector wrapped_without(const KnotVector& fine, const std::vector<double>& kept) {
  const int wrapped = wrapped_poles(fine);
  ISOCHOR_REQUIRE(wrapped > 0, fine.begin(), fine.end());
  const int d = fine.degree();
  const int at_begin = fine.multiplicity(fine.begin());
  const double period = fine.end() - fine.begin();
  // The last copy of begin() has index d; without interior knots a period holds `at_begin` knots.
  std::vector<double> bare;
  for (int i = 0; i < at_begin + wrapped + d + 1; ++i) {
    const int from_first = i - (d - at_begin + 1);
    int turn = from_first / at_begin;
    if (from_first < 0 && from_first % at_begin != 0) --turn;
    bare.push_back(turn == 1 ? fine.end() : fine.begin() + turn * period);
  }
  return wrapped_with_knots(KnotVector(d, std::move(bare)), kept);
}

template <typename T>
std::vector<T> remove_published(const KnotVector& fine, const KnotVector& coarse,
                                std::vector<T> theta) {
  const int d = fine.degree();
  const int n = fine.size();
  ISOCHOR_REQUIRE(static_cast<int>(theta.size()) == n, theta.size(), n);
  const std::vector<double> removed = inserted_knots(coarse, fine);
  std::vector<double> u = fine.knots();
  const auto at = [&](int i) -> T& { return theta[static_cast<size_t>(i)]; };
  const auto knot = [&](int i) -> double& { return u[static_cast<size_t>(i)]; };
  auto next_removed = removed.begin();
  int m = d + 1;
  for (int l = d + 1; l <= n - 1; ++l) {
    if (next_removed == removed.end() || knot(l) != *next_removed) {
      at(m) = at(l);
      knot(m) = knot(l);
      ++m;
      continue;
    }
    ++next_removed;
    for (int r = 0; r < d; ++r) {
      const int k = m - d - 1 + r;
      at(k) = (knot(l) - knot(k)) / (knot(l + r) - knot(k)) * at(k) +
              (knot(l + r + 1) - knot(l)) / (knot(l + r + 1) - knot(k + 1)) * at(k + 1);
    }
    at(m - 1) = (knot(l) - knot(m - 1)) / (knot(l + d) - knot(m - 1)) * at(m - 1) + at(l);
  }
  theta.resize(static_cast<size_t>(m));
  return theta;
}

}  // namespace

std::vector<double> interior_breaks(const KnotVector& knots) {
  std::vector<double> breaks = knots.interior();
  breaks.erase(std::unique(breaks.begin(), breaks.end()), breaks.end());
  return breaks;
}

TwoScale keep_flagged(const KnotVector& fine, const std::vector<bool>& kept, Wrap wrap) {
  const std::vector<double> breaks = interior_breaks(fine);
  ISOCHOR_REQUIRE(breaks.size() == kept.size(), breaks.size(), kept.size());
  const auto stays = [&](double t) {
    const auto at = std::lower_bound(breaks.begin(), breaks.end(), t) - breaks.begin();
    return static_cast<bool>(kept[static_cast<size_t>(at)]);
  };
  if (wrap == Wrap::kNo) {
    KnotVector coarse = without(fine, [&](double t) { return !stays(t); });
    BandedMap map = insertion_map(coarse, fine);
    return {std::move(coarse), std::move(map)};
  }
  std::vector<double> values;
  for (double t : fine.interior()) {
    if (stays(t)) values.push_back(t);
  }
  KnotVector coarse = wrapped_without(fine, values);
  BandedMap map = wrapped_insertion_map(coarse, fine);
  return {std::move(coarse), std::move(map)};
}

TwoScale keep_every(const KnotVector& fine, int k, Wrap wrap) {
  if (k < 1) throw InputError("", "scale.every", std::to_string(k) + " is not at least 1");
  std::vector<bool> kept(interior_breaks(fine).size());
  for (size_t i = 0; i < kept.size(); ++i) kept[i] = (i + 1) % static_cast<size_t>(k) == 0;
  return keep_flagged(fine, kept, wrap);
}

TwoScale keep_knots(const KnotVector& fine, const std::vector<double>& kept, Wrap wrap) {
  const std::vector<double> breaks = interior_breaks(fine);
  std::vector<bool> flags(breaks.size(), false);
  for (double value : kept) {
    const auto found = std::lower_bound(breaks.begin(), breaks.end(), value);
    if (found != breaks.end() && *found == value) {
      flags[static_cast<size_t>(found - breaks.begin())] = true;
      continue;
    }
    std::string reason = number(value) + " is not an interior knot";
    if (found != breaks.begin()) reason += "; the next lower one is " + number(*(found - 1));
    if (found != breaks.end()) reason += "; the next higher one is " + number(*found);
    throw InputError("", "scale.knots", reason);
  }
  return keep_flagged(fine, flags, wrap);
}

std::vector<double> remove_knots_published(const KnotVector& fine, const KnotVector& coarse,
                                           std::vector<double> gradient) {
  return remove_published(fine, coarse, std::move(gradient));
}

std::vector<Vec3> remove_knots_published(const KnotVector& fine, const KnotVector& coarse,
                                         std::vector<Vec3> gradient) {
  return remove_published(fine, coarse, std::move(gradient));
}

std::vector<Vec3> remove_knots_published(const KnotVector& fine_u, const KnotVector& coarse_u,
                                         const KnotVector& fine_v, const KnotVector& coarse_v,
                                         const std::vector<Vec3>& gradient) {
  const auto rows = static_cast<size_t>(fine_u.size());
  const auto columns = static_cast<size_t>(fine_v.size());
  const auto coarse_rows = static_cast<size_t>(coarse_u.size());
  ISOCHOR_REQUIRE(gradient.size() == rows * columns, gradient.size(), rows, columns);
  std::vector<Vec3> half(coarse_rows * columns);
  for (size_t j = 0; j < columns; ++j) {
    std::vector<Vec3> column;
    for (size_t i = 0; i < rows; ++i) column.push_back(gradient[i * columns + j]);
    column = remove_published(fine_u, coarse_u, std::move(column));
    for (size_t i = 0; i < coarse_rows; ++i) half[i * columns + j] = column[i];
  }
  std::vector<Vec3> result;
  for (size_t i = 0; i < coarse_rows; ++i) {
    const auto row = half.begin() + static_cast<long>(i * columns);
    const std::vector<Vec3> coarse = remove_published(
        fine_v, coarse_v, std::vector<Vec3>(row, row + static_cast<long>(columns)));
    result.insert(result.end(), coarse.begin(), coarse.end());
  }
  return result;
}

}  // namespace isochor
