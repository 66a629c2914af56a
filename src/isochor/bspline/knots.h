// Knot vectors.
//
// Symbols: degree d, knots t_0 <= t_1 <= ... <= t_{n+d}, n basis functions B_0 .. B_{n-1}.
// B_i has support [t_i, t_{i+d+1}]. The domain is [t_d, t_n]. Span k is [t_k, t_{k+1}).
//
// Clamped, unclamped and periodic vectors are all written this way: a periodic direction is an
// unclamped vector whose first and last coefficients are tied (see patch_model.h).
//
// Laws:
//  (1) invariant: 1 <= d <= 25, knots finite and non-decreasing, t_d < t_n, multiplicity at most d
//      inside the domain and at most d + 1 at its ends;
//  (2) comparison is exact: two knots are the same or they are different.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace isochor {

inline constexpr int kMaxDegree = 25;

// An immutable knot vector; copies share their data.
class KnotVector {
 public:
  // Throws PreconditionError when law (1) is broken; ask `defect` first for data from outside.
  KnotVector(int degree, std::vector<double> knots);

  // What is wrong with these knots, in words with numbers; empty when law (1) holds.
  static std::string defect(int degree, const std::vector<double>& knots);

  // The clamped vector over the given breaks, all interior ones simple.
  static KnotVector clamped(int degree, const std::vector<double>& breaks);
  // The clamped vector with `spans` equal spans over [begin, end].
  static KnotVector uniform(int degree, int spans, double begin = 0.0, double end = 1.0);

  int degree() const { return data_->degree; }
  // n, the number of basis functions.
  int size() const { return static_cast<int>(data_->knots.size()) - data_->degree - 1; }
  const std::vector<double>& knots() const { return data_->knots; }
  double operator[](int i) const { return data_->knots[static_cast<size_t>(i)]; }
  double begin() const { return data_->knots[static_cast<size_t>(degree())]; }
  double end() const { return data_->knots[static_cast<size_t>(size())]; }

  // The span index k with d <= k < n, t_k < t_{k+1} and t_k <= u < t_{k+1}; the last non-empty span
  // for u >= end(), the first for u < begin(). Cost O(log n).
  int span_of(double u) const;
  // The non-empty span indices inside the domain, ascending.
  const std::vector<int>& spans() const { return data_->spans; }
  // The distinct knots of the domain, ascending: begin(), interior breaks, end().
  std::vector<double> breaks() const;
  // The interior knots, strictly between begin() and end(), with multiplicity.
  std::vector<double> interior() const;
  // How often `value` occurs among all knots.
  int multiplicity(double value) const;

  // Greville abscissa (t_{i+1} + ... + t_{i+d}) / d: where coefficient i "is".
  double greville(int i) const;
  bool clamped_begin() const { return data_->clamped_begin; }
  bool clamped_end() const { return data_->clamped_end; }

  friend bool operator==(const KnotVector& a, const KnotVector& b) {
    return a.data_ == b.data_ || (a.degree() == b.degree() && a.data_->knots == b.data_->knots);
  }
  friend bool operator!=(const KnotVector& a, const KnotVector& b) { return !(a == b); }

 private:
  struct Data {
    int degree;
    std::vector<double> knots;
    std::vector<int> spans;
    bool clamped_begin;
    bool clamped_end;
  };
  std::shared_ptr<const Data> data_;
};

}  // namespace isochor
