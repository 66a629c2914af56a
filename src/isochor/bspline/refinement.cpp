#include "isochor/bspline/refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"

namespace isochor {
namespace {

std::string number(double value) {
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

// Row of the Oslo matrix: the coarse functions of span `mu`, blossomed at arguments[1] ..
// arguments[d]. Functions that the knot vector does not have (beyond its first and last knots) only
// feed each other, so they are left out. Each step divides before it multiplies: then a quotient
// that should be 1 is 1, which is what makes untouched rows exact units (law 3).
BandedMap::RowData oslo_row(const std::vector<double>& t, int d, int mu, const double* arguments) {
  const int last = static_cast<int>(t.size()) - 1;
  const auto knot = [&](int i) { return t[static_cast<size_t>(i)]; };
  std::array<double, kMaxDegree + 1> current{};
  current[0] = 1.0;
  for (int p = 1; p <= d; ++p) {
    const double x = arguments[p];
    double carried = 0.0;
    for (int j = 0; j < p; ++j) {
      const int left = mu - p + 1 + j;
      const int right = mu + 1 + j;
      double& value = current[static_cast<size_t>(j)];
      if (left < 0 || right > last || value == 0.0) {
        value = carried;
        carried = 0.0;
        continue;
      }
      const double width = knot(right) - knot(left);
      const double moved = value * ((x - knot(left)) / width);
      value = carried + value * ((knot(right) - x) / width);
      carried = moved;
    }
    current[static_cast<size_t>(p)] = carried;
  }
  const int n = last - d;
  BandedMap::RowData row;
  row.first = std::max(mu - d, 0);
  for (int j = row.first; j <= std::min(mu, n - 1); ++j) {
    row.coefficients.push_back(current[static_cast<size_t>(j - mu + d)]);
  }
  return row;
}

// The last index whose knot is not above x.
int knot_index(const std::vector<double>& t, double x) {
  return static_cast<int>(std::upper_bound(t.begin(), t.end(), x) - t.begin()) - 1;
}

template <typename T>
T zero();
template <>
double zero<double>() {
  return 0.0;
}
template <>
Vec3 zero<Vec3>() {
  return Vec3::Zero();
}

// The first term starts the sum, so that unit rows keep even the sign of a zero.
template <typename T>
std::vector<T> multiply(const BandedMap& map, const std::vector<T>& coarse) {
  ISOCHOR_REQUIRE(static_cast<int>(coarse.size()) == map.size_coarse(), coarse.size(),
                  map.size_coarse());
  std::vector<T> fine;
  fine.reserve(static_cast<size_t>(map.size_fine()));
  for (int i = 0; i < map.size_fine(); ++i) {
    const BandedMap::Row row = map.row(i);
    T sum = row.coefficients[0] * coarse[static_cast<size_t>(row.first)];
    for (int k = 1; k < row.count; ++k) {
      sum += row.coefficients[k] * coarse[static_cast<size_t>(row.first + k)];
    }
    fine.push_back(sum);
  }
  return fine;
}

template <typename T>
std::vector<T> multiply_transposed(const BandedMap& map, const std::vector<T>& fine) {
  ISOCHOR_REQUIRE(static_cast<int>(fine.size()) == map.size_fine(), fine.size(), map.size_fine());
  std::vector<T> coarse(static_cast<size_t>(map.size_coarse()), zero<T>());
  for (int i = 0; i < map.size_fine(); ++i) {
    const BandedMap::Row row = map.row(i);
    for (int k = 0; k < row.count; ++k) {
      coarse[static_cast<size_t>(row.first + k)] +=
          row.coefficients[k] * fine[static_cast<size_t>(i)];
    }
  }
  return coarse;
}

// Poles and weights of a grid on their way through a refinement.
struct WeightedGrid {
  std::vector<Vec3> poles;
  std::vector<double> weights;  // may be empty
};

// Refines the first index of a `rows` x `columns` grid; the result is transposed, so applying it
// twice refines both directions and restores the order.
WeightedGrid refine_and_transpose(const BandedMap& map, const WeightedGrid& grid, size_t columns) {
  const auto fine = static_cast<size_t>(map.size_fine());
  WeightedGrid out;
  out.poles.resize(fine * columns);
  out.weights.resize(grid.weights.empty() ? 0 : fine * columns);
  for (size_t i = 0; i < fine; ++i) {
    const BandedMap::Row row = map.row(static_cast<int>(i));
    for (size_t j = 0; j < columns; ++j) {
      const size_t from = static_cast<size_t>(row.first) * columns + j;
      const size_t to = j * fine + i;
      if (row.unit()) {
        out.poles[to] = grid.poles[from];
        if (!grid.weights.empty()) out.weights[to] = grid.weights[from];
        continue;
      }
      Vec3 pole = Vec3::Zero();
      double weight = 0.0;
      for (int k = 0; k < row.count; ++k) {
        const size_t at = from + static_cast<size_t>(k) * columns;
        const double c = row.coefficients[k] * (grid.weights.empty() ? 1.0 : grid.weights[at]);
        pole += c * grid.poles[at];
        weight += c;
      }
      if (grid.weights.empty()) {
        out.poles[to] = pole;
      } else {
        out.poles[to] = pole / weight;
        out.weights[to] = weight;
      }
    }
  }
  return out;
}

std::vector<Vec3> grid_product(const BandedMap& map, const std::vector<Vec3>& grid, size_t columns,
                               bool transposed) {
  // One column at a time through the vector product; the result is transposed.
  const auto rows = grid.size() / columns;
  std::vector<Vec3> out;
  std::vector<Vec3> column(rows);
  for (size_t j = 0; j < columns; ++j) {
    for (size_t i = 0; i < rows; ++i) column[i] = grid[i * columns + j];
    const std::vector<Vec3> product = transposed ? map.apply_transposed(column) : map.apply(column);
    out.insert(out.end(), product.begin(), product.end());
  }
  return out;
}

}  // namespace

BandedMap::BandedMap(int size_coarse, const std::vector<RowData>& rows)
    : size_coarse_(size_coarse) {
  begin_.push_back(0);
  for (const RowData& row : rows) {
    size_t low = 0;
    size_t high = row.coefficients.size();
    while (low < high && row.coefficients[low] == 0.0) ++low;
    while (low < high && row.coefficients[high - 1] == 0.0) --high;
    ISOCHOR_REQUIRE(low < high, first_.size());
    const int first = row.first + static_cast<int>(low);
    ISOCHOR_REQUIRE(0 <= first && row.first + static_cast<int>(high) <= size_coarse, row.first,
                    size_coarse);
    first_.push_back(first);
    coefficients_.insert(coefficients_.end(), row.coefficients.begin() + static_cast<long>(low),
                         row.coefficients.begin() + static_cast<long>(high));
    begin_.push_back(coefficients_.size());
  }
}

BandedMap BandedMap::identity(int size) {
  std::vector<RowData> rows;
  for (int i = 0; i < size; ++i) rows.push_back({i, {1.0}});
  return BandedMap(size, rows);
}

BandedMap::Row BandedMap::row(int i) const {
  ISOCHOR_REQUIRE(0 <= i && i < size_fine(), i, size_fine());
  const auto at = static_cast<size_t>(i);
  return {first_[at], static_cast<int>(begin_[at + 1] - begin_[at]), &coefficients_[begin_[at]]};
}

std::vector<double> BandedMap::apply(const std::vector<double>& coarse) const {
  return multiply(*this, coarse);
}
std::vector<Vec3> BandedMap::apply(const std::vector<Vec3>& coarse) const {
  return multiply(*this, coarse);
}
std::vector<double> BandedMap::apply_transposed(const std::vector<double>& fine) const {
  return multiply_transposed(*this, fine);
}
std::vector<Vec3> BandedMap::apply_transposed(const std::vector<Vec3>& fine) const {
  return multiply_transposed(*this, fine);
}

std::vector<Vec3> apply_to_grid(const BandedMap& u, const BandedMap& v,
                                const std::vector<Vec3>& coarse) {
  const auto columns = static_cast<size_t>(v.size_coarse());
  ISOCHOR_REQUIRE(coarse.size() == static_cast<size_t>(u.size_coarse()) * columns, coarse.size());
  const std::vector<Vec3> half = grid_product(u, coarse, columns, false);
  return grid_product(v, half, static_cast<size_t>(u.size_fine()), false);
}

std::vector<Vec3> apply_transposed_to_grid(const BandedMap& u, const BandedMap& v,
                                           const std::vector<Vec3>& fine) {
  const auto columns = static_cast<size_t>(v.size_fine());
  ISOCHOR_REQUIRE(fine.size() == static_cast<size_t>(u.size_fine()) * columns, fine.size());
  const std::vector<Vec3> half = grid_product(u, fine, columns, true);
  return grid_product(v, half, static_cast<size_t>(u.size_coarse()), true);
}

std::vector<double> inserted_knots(const KnotVector& coarse, const KnotVector& fine) {
  ISOCHOR_REQUIRE(coarse.degree() == fine.degree(), coarse.degree(), fine.degree());
  ISOCHOR_REQUIRE(coarse.begin() == fine.begin() && coarse.end() == fine.end(), coarse.begin(),
                  fine.begin(), coarse.end(), fine.end());
  const std::vector<double> few = coarse.interior();
  const std::vector<double> many = fine.interior();
  std::vector<double> missing;
  std::set_difference(few.begin(), few.end(), many.begin(), many.end(),
                      std::back_inserter(missing));
  ISOCHOR_REQUIRE(missing.empty(), "the finer vector lacks the knot", missing.front());
  std::vector<double> inserted;
  std::set_difference(many.begin(), many.end(), few.begin(), few.end(),
                      std::back_inserter(inserted));
  return inserted;
}

BandedMap insertion_map(const KnotVector& coarse, const KnotVector& fine) {
  const std::vector<double> inserted = inserted_knots(coarse, fine);
  ISOCHOR_REQUIRE(fine == with_knots(coarse, inserted),
                  "knots outside the domain differ between the two vectors");
  const int d = coarse.degree();
  std::vector<BandedMap::RowData> rows;
  rows.reserve(static_cast<size_t>(fine.size()));
  for (int i = 0; i < fine.size(); ++i) {
    rows.push_back(oslo_row(coarse.knots(), d, knot_index(coarse.knots(), fine[i]),
                            &fine.knots()[static_cast<size_t>(i)]));
  }
  return BandedMap(coarse.size(), rows);
}

KnotVector with_knots(const KnotVector& knots, std::vector<double> inserted) {
  std::sort(inserted.begin(), inserted.end());
  for (double value : inserted) {
    if (!(knots.begin() < value && value < knots.end())) {
      throw InputError("", "knots",
                       "cannot insert " + number(value) + ": it is not inside (" +
                           number(knots.begin()) + ", " + number(knots.end()) + ")");
    }
  }
  std::vector<double> merged(knots.knots().size() + inserted.size());
  std::merge(knots.knots().begin(), knots.knots().end(), inserted.begin(), inserted.end(),
             merged.begin());
  const std::string wrong = KnotVector::defect(knots.degree(), merged);
  if (!wrong.empty()) throw InputError("", "knots", "after insertion " + wrong);
  return KnotVector(knots.degree(), std::move(merged));
}

KnotVector common_knots(const KnotVector& a, const KnotVector& b) {
  ISOCHOR_REQUIRE(a.degree() == b.degree(), a.degree(), b.degree());
  ISOCHOR_REQUIRE(a.begin() == b.begin() && a.end() == b.end(), a.begin(), b.begin(), a.end(),
                  b.end());
  const std::vector<double> in_a = a.interior();
  const std::vector<double> in_b = b.interior();
  std::vector<double> only_b;
  std::set_difference(in_b.begin(), in_b.end(), in_a.begin(), in_a.end(),
                      std::back_inserter(only_b));
  std::vector<double> only_a;
  std::set_difference(in_a.begin(), in_a.end(), in_b.begin(), in_b.end(),
                      std::back_inserter(only_a));
  KnotVector common = with_knots(a, std::move(only_b));
  ISOCHOR_REQUIRE(common == with_knots(b, std::move(only_a)),
                  "knots outside the domain differ between the two vectors");
  return common;
}

namespace {

// The endless knot sequence of a periodic spline: N knots in a period, index `origin` holds the
// first copy of begin().
struct EndlessKnots {
  std::vector<double> period;  // from begin() on, below end()
  double length = 0.0;
  int origin = 0;

  double at(int i) const {
    const int count = static_cast<int>(period.size());
    int turn = (i - origin) / count;
    int rest = (i - origin) % count;
    if (rest < 0) {
      rest += count;
      --turn;
    }
    return period[static_cast<size_t>(rest)] + turn * length;
  }
};

EndlessKnots endless(const KnotVector& knots) {
  EndlessKnots out;
  out.length = knots.end() - knots.begin();
  for (double t : knots.knots()) {
    if (knots.begin() <= t && t < knots.end()) out.period.push_back(t);
  }
  out.origin =
      static_cast<int>(std::lower_bound(knots.knots().begin(), knots.knots().end(), knots.begin()) -
                       knots.knots().begin());
  return out;
}

}  // namespace

int wrapped_poles(const KnotVector& knots) {
  const EndlessKnots ideal = endless(knots);
  const int wrapped = knots.size() - static_cast<int>(ideal.period.size());
  if (wrapped < 1 || wrapped > knots.degree()) return 0;
  // Each knot carries a rounding of its own size, and the shift by a period one more.
  const double scale = std::max({std::abs(knots[0]), std::abs(knots.knots().back()), ideal.length});
  for (int i = 0; i < static_cast<int>(knots.knots().size()); ++i) {
    if (std::abs(knots[i] - ideal.at(i)) > kSameKnot * scale) return 0;
  }
  return wrapped;
}

KnotVector wrapped_with_knots(const KnotVector& knots, std::vector<double> inserted) {
  const int wrapped = wrapped_poles(knots);
  ISOCHOR_REQUIRE(wrapped > 0, knots.begin(), knots.end());
  const KnotVector inside = with_knots(knots, std::move(inserted));
  EndlessKnots ideal = endless(inside);
  ideal.origin = endless(knots).origin;
  const int count = static_cast<int>(ideal.period.size()) + wrapped + knots.degree() + 1;
  std::vector<double> values;
  for (int i = 0; i < count; ++i) {
    double value = ideal.at(i);
    if (value < knots.begin() || i >= ideal.origin + static_cast<int>(ideal.period.size())) {
      // Keep the file's own rounding of a knot that was there before.
      for (double old : knots.knots()) {
        if (std::abs(old - value) <= kSameKnot * ideal.length) value = old;
      }
    }
    values.push_back(value);
  }
  return KnotVector(knots.degree(), std::move(values));
}

BandedMap wrapped_insertion_map(const KnotVector& coarse, const KnotVector& fine) {
  (void)inserted_knots(coarse, fine);  // `fine` must contain `coarse`
  ISOCHOR_REQUIRE(wrapped_poles(coarse) > 0 && wrapped_poles(coarse) == wrapped_poles(fine),
                  wrapped_poles(coarse), wrapped_poles(fine));
  const int d = coarse.degree();
  const EndlessKnots coarse_ideal = endless(coarse);
  EndlessKnots fine_ideal = endless(fine);
  fine_ideal.origin = coarse_ideal.origin;
  const int period = static_cast<int>(coarse_ideal.period.size());
  const auto fine_period = fine_ideal.period.size();
  // Enough turns of the coarse knots on both sides for every fine function.
  const int margin = (d / period + 2) * period;
  std::vector<double> extended;
  for (int i = -margin; i < coarse.size() + d + 1 + margin; ++i) {
    extended.push_back(coarse_ideal.at(i));
  }
  std::vector<BandedMap::RowData> rows;
  std::vector<double> arguments(static_cast<size_t>(d) + 1);
  for (int i = 0; i < fine.size(); ++i) {
    if (rows.size() >= fine_period) {
      // A period further on the knots are the same but for rounding: the same row to the last bit.
      rows.push_back(rows[rows.size() - fine_period]);
      continue;
    }
    for (int k = 0; k <= d; ++k) arguments[static_cast<size_t>(k)] = fine_ideal.at(i + k);
    const int mu = knot_index(extended, arguments[0]);
    BandedMap::RowData row = oslo_row(extended, d, mu, arguments.data());
    // Shift by whole periods until the span lies in the domain; its d + 1 functions then exist.
    int inside = mu - margin;
    while (inside < d) inside += period;
    while (inside >= d + period) inside -= period;
    row.first += inside - mu;
    rows.push_back(std::move(row));
  }
  return BandedMap(coarse.size(), rows);
}

namespace {

KnotVector with_divided_spans(const KnotVector& knots, const std::vector<int>& pieces) {
  std::vector<double> inserted;
  for (size_t s = 0; s < pieces.size(); ++s) {
    const int k = knots.spans()[s];
    for (int i = 1; i < pieces[s]; ++i) {
      const double share = static_cast<double>(i) / pieces[s];
      inserted.push_back(knots[k] + (knots[k + 1] - knots[k]) * share);
    }
  }
  return with_knots(knots, std::move(inserted));
}

}  // namespace

KnotVector refined_to_spans(const KnotVector& knots, int spans) {
  if (spans < 1 || spans > kMaxSpans) {
    throw InputError("", "spans",
                     std::to_string(spans) + " is not between 1 and " + std::to_string(kMaxSpans));
  }
  const auto& old = knots.spans();
  std::vector<int> pieces(old.size(), 1);
  int total = static_cast<int>(old.size());
  const auto piece_length = [&](size_t s) {
    return (knots[old[s] + 1] - knots[old[s]]) / pieces[s];
  };
  while (total < spans) {
    double longest = 0.0;
    for (size_t s = 0; s < old.size(); ++s) longest = std::max(longest, piece_length(s));
    // Spans that are equal but for rounding are divided together, so symmetric knots stay so.
    for (size_t s = 0; s < old.size(); ++s) {
      if (piece_length(s) >= longest * (1.0 - kSameLength)) {
        ++pieces[s];
        ++total;
      }
    }
  }
  return with_divided_spans(knots, pieces);
}

KnotVector refined_to_length(const KnotVector& knots, double length) {
  const double domain = knots.end() - knots.begin();
  if (!(length > 0.0) || !(domain / length < kMaxSpans)) {
    throw InputError("", "length",
                     number(length) + " does not divide a domain of length " + number(domain) +
                         " into at most " + std::to_string(kMaxSpans) + " spans");
  }
  std::vector<int> pieces;
  for (int k : knots.spans()) {
    const double ratio = (knots[k + 1] - knots[k]) / length;
    pieces.push_back(std::max(1, static_cast<int>(std::ceil(ratio * (1.0 - kSameLength)))));
  }
  return with_divided_spans(knots, pieces);
}

Surface refine(const Surface& surface, const KnotVector& u_knots, const KnotVector& v_knots) {
  return refine(surface, u_knots, insertion_map(surface.u_knots(), u_knots), v_knots,
                insertion_map(surface.v_knots(), v_knots));
}

Surface refine(const Surface& surface, const KnotVector& u_knots, const BandedMap& u_map,
               const KnotVector& v_knots, const BandedMap& v_map) {
  ISOCHOR_REQUIRE(u_map.size_coarse() == surface.u_size() && u_map.size_fine() == u_knots.size(),
                  u_map.size_coarse(), u_map.size_fine());
  ISOCHOR_REQUIRE(v_map.size_coarse() == surface.v_size() && v_map.size_fine() == v_knots.size(),
                  v_map.size_coarse(), v_map.size_fine());
  WeightedGrid grid{surface.poles(), surface.weights()};
  grid = refine_and_transpose(u_map, grid, static_cast<size_t>(surface.v_size()));
  grid = refine_and_transpose(v_map, grid, static_cast<size_t>(u_knots.size()));
  return Surface(u_knots, v_knots, std::move(grid.poles), std::move(grid.weights));
}

}  // namespace isochor
