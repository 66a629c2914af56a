#include "isochor/bspline/knots.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "isochor/base/error.h"

namespace isochor {

std::string KnotVector::defect(int degree, const std::vector<double>& knots) {
  std::ostringstream text;
  text.precision(17);
  if (degree < 1 || degree > kMaxDegree) {
    text << "degree " << degree << " is not between 1 and " << kMaxDegree;
    return text.str();
  }
  const auto d = static_cast<size_t>(degree);
  if (knots.size() < 2 * d + 2) {
    text << knots.size() << " knots are too few for degree " << degree << " (at least " << 2 * d + 2
         << ")";
    return text.str();
  }
  for (size_t i = 0; i < knots.size(); ++i) {
    if (!std::isfinite(knots[i])) {
      text << "knot " << i << " is not a finite number";
      return text.str();
    }
    if (i > 0 && knots[i] < knots[i - 1]) {
      text << "knot " << i << " decreases: " << knots[i] << " after " << knots[i - 1];
      return text.str();
    }
  }
  const double begin = knots[d];
  const double end = knots[knots.size() - d - 1];
  if (!(begin < end)) {
    text << "the domain [" << begin << ", " << end << "] is empty";
    return text.str();
  }
  for (size_t i = 0; i < knots.size();) {
    size_t next = i;
    while (next < knots.size() && knots[next] == knots[i]) ++next;
    const bool inside = begin < knots[i] && knots[i] < end;
    const size_t allowed = inside ? d : d + 1;
    if (next - i > allowed) {
      text << "knot " << knots[i] << " has multiplicity " << next - i << ", more than " << allowed;
      return text.str();
    }
    i = next;
  }
  return {};
}

KnotVector::KnotVector(int degree, std::vector<double> knots) {
  const std::string wrong = defect(degree, knots);
  ISOCHOR_REQUIRE(wrong.empty(), wrong);
  auto data = std::make_shared<Data>();
  data->degree = degree;
  data->knots = std::move(knots);
  const auto& t = data->knots;
  const int n = static_cast<int>(t.size()) - degree - 1;
  for (int k = degree; k < n; ++k) {
    if (t[static_cast<size_t>(k)] < t[static_cast<size_t>(k) + 1]) data->spans.push_back(k);
  }
  data->clamped_begin = t.front() == t[static_cast<size_t>(degree)];
  data->clamped_end = t.back() == t[static_cast<size_t>(n)];
  data_ = std::move(data);
}

KnotVector KnotVector::clamped(int degree, const std::vector<double>& breaks) {
  ISOCHOR_REQUIRE(breaks.size() >= 2, breaks.size());
  ISOCHOR_REQUIRE(1 <= degree && degree <= kMaxDegree, defect(degree, breaks));
  const auto ends = static_cast<size_t>(degree);
  std::vector<double> knots(ends, breaks.front());
  knots.insert(knots.end(), breaks.begin(), breaks.end());
  knots.insert(knots.end(), ends, breaks.back());
  return KnotVector(degree, std::move(knots));
}

KnotVector KnotVector::uniform(int degree, int spans, double begin, double end) {
  ISOCHOR_REQUIRE(spans >= 1, spans);
  std::vector<double> breaks(static_cast<size_t>(spans) + 1);
  for (int i = 0; i <= spans; ++i) {
    breaks[static_cast<size_t>(i)] = begin + (end - begin) * i / spans;
  }
  breaks.back() = end;
  return clamped(degree, breaks);
}

int KnotVector::span_of(double u) const {
  const auto& t = data_->knots;
  const auto first = t.begin() + degree();
  const auto last = t.begin() + size();
  const auto above = std::upper_bound(first, last, u);
  // `above` is the first knot greater than u among t_d .. t_{n-1}; the span starts just before it.
  int k = static_cast<int>(above - t.begin()) - 1;
  k = std::max(k, spans().front());
  return std::min(k, spans().back());
}

std::vector<double> KnotVector::breaks() const {
  std::vector<double> values;
  for (int k : spans()) values.push_back((*this)[k]);
  values.push_back(end());
  return values;
}

std::vector<double> KnotVector::interior() const {
  std::vector<double> values;
  for (double t : knots()) {
    if (begin() < t && t < end()) values.push_back(t);
  }
  return values;
}

int KnotVector::multiplicity(double value) const {
  const auto range = std::equal_range(knots().begin(), knots().end(), value);
  return static_cast<int>(range.second - range.first);
}

double KnotVector::greville(int i) const {
  ISOCHOR_REQUIRE(0 <= i && i < size(), i, size());
  double sum = 0.0;
  for (int k = 1; k <= degree(); ++k) sum += (*this)[i + k];
  return std::clamp(sum / degree(), begin(), end());
}

}  // namespace isochor
