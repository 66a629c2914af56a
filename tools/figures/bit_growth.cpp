#include "figures/bit_growth.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <random>

#include "isochor/ecles/ldu.h"

namespace figures {
namespace {

using isochor::IntegerMatrix;
using isochor::LduFactoring;
using isochor::LduStep;
using isochor::Simplification;

using Random = std::mt19937_64;
using Maker = std::function<IntegerMatrix(Random&)>;

constexpr int kBits = 10;  // of the entries, with their sign

// The largest bits of what is left at the end, and of what was there after any step.
struct Bits {
  unsigned long upper = 0, lower = 0, diagonal = 0;
  unsigned long lower_on_the_way = 0, diagonal_on_the_way = 0;

  double at_the_end() const { return static_cast<double>(std::max({upper, lower, diagonal})); }
  double on_the_way() const {
    return static_cast<double>(std::max({upper, lower_on_the_way, diagonal_on_the_way}));
  }
  void raise(const Bits& b) {
    upper = std::max(upper, b.upper);
    lower = std::max(lower, b.lower);
    diagonal = std::max(diagonal, b.diagonal);
    lower_on_the_way = std::max(lower_on_the_way, b.lower_on_the_way);
    diagonal_on_the_way = std::max(diagonal_on_the_way, b.diagonal_on_the_way);
  }
};

struct Measured {
  int rank = 0;
  Bits bits;
};

Measured measure(const IntegerMatrix& matrix, Simplification simplification) {
  Measured result;
  const LduFactoring factoring =
      isochor::factor_ldu(matrix, simplification, [&](const LduStep& step) {
        result.bits.upper = std::max(result.bits.upper, step.upper_bits);
        result.bits.lower_on_the_way = std::max(result.bits.lower_on_the_way, step.lower_bits);
        result.bits.diagonal_on_the_way =
            std::max(result.bits.diagonal_on_the_way, step.diagonal_bits);
      });
  result.rank = factoring.rank();
  result.bits.lower = factoring.lower.max_bits();
  for (const auto& entry : factoring.diagonal) {
    result.bits.diagonal = std::max(result.bits.diagonal, entry.bits());
  }
  return result;
}

Bits largest(const Maker& make, Simplification simplification, int matrices, unsigned long seed) {
  Random random(seed);
  Bits result;
  for (int k = 0; k < matrices; ++k) result.raise(measure(make(random), simplification).bits);
  return result;
}

IntegerMatrix random_matrix(Random& random, int rows, int columns, double density, long size) {
  std::uniform_int_distribution<long> entry(-size, size - 1);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  IntegerMatrix result(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      if (density >= 1.0 || chance(random) < density) result.set(i, j, entry(random));
    }
  }
  return result;
}

Maker full(int rows, int columns, double density = 1.0) {
  return [=](Random& random) {
    return random_matrix(random, rows, columns, density, 1L << (kBits - 1));
  };
}

// A product through `inner` columns, so that the rank is at most that. The factors are so sparse
// that the product has about the density, and so small that it has about kBits.
Maker through(int size, int inner, double density) {
  const double of_factors =
      density >= 1.0 ? 1.0 : std::sqrt(1.0 - std::pow(1.0 - density, 1.0 / inner));
  const double terms = std::max(1.0, inner * of_factors * of_factors);
  const auto entry = std::lround(std::ceil(std::sqrt(std::pow(2.0, kBits - 1) / terms)));
  return [=](Random& random) {
    const IntegerMatrix left = random_matrix(random, size, inner, of_factors, entry);
    return left * random_matrix(random, inner, size, of_factors, entry);
  };
}

const char* const kLargest = "largest entry, binary digits";
const char* const kRows = "rows m";

NamedPlot without_simplification(int matrices) {
  Plot plot{"7.1  No simplification, m x 15", kRows, kLargest, {}, true};
  Curve upper{"U", {}, false};
  Curve others{"L, D", {}, false};
  Curve bound{"10 · 2^(r - 1)", {}, true};
  for (int m = 1; m <= 20; ++m) {
    const Bits bits = largest(full(m, 15), Simplification::kNone, matrices, 7100UL + m);
    upper.points.emplace_back(m, bits.upper);
    others.points.emplace_back(m, std::max(bits.lower_on_the_way, bits.diagonal_on_the_way));
    bound.points.emplace_back(m, kBits * std::pow(2.0, std::min(m, 15) - 1));
  }
  plot.curves = {upper, others, bound};
  return {"figure_7_1", plot};
}

// What remains, and what was there on the way to it.
std::vector<NamedPlot> by_gcd(int matrices) {
  Plot end{"7.2  Greatest common divisors, m = n", kRows, kLargest, {}};
  Plot way{"7.2  The same, on the way", kRows, kLargest, {}};
  end.curves = {{"U", {}, false}, {"L", {}, false}, {"D", {}, false}};
  way.curves = {{"U", {}, false}, {"L on the way", {}, true}, {"D on the way", {}, true}};
  for (int m = 2; m <= 40; m += 2) {
    const Bits bits = largest(full(m, m), Simplification::kGcd, matrices, 7200UL + m);
    end.curves[0].points.emplace_back(m, bits.upper);
    end.curves[1].points.emplace_back(m, bits.lower);
    end.curves[2].points.emplace_back(m, bits.diagonal);
    way.curves[0].points.emplace_back(m, bits.upper);
    way.curves[1].points.emplace_back(m, bits.lower_on_the_way);
    way.curves[2].points.emplace_back(m, bits.diagonal_on_the_way);
  }
  return {{"figure_7_2", end}, {"figure_7_2_on_the_way", way}};
}

// GCD at the end and on the way, and Turner, whose entries are minors on the way too.
struct Comparison {
  std::map<double, Bits> gcd, turner;

  void add_to(Plot& plot, const std::string& suffix = "") const {
    Curve end{"GCD" + suffix, {}, false};
    Curve way{"GCD on the way" + suffix, {}, true};
    Curve minors{"Turner" + suffix, {}, false};
    for (const auto& [x, bits] : gcd) {
      end.points.emplace_back(x, bits.at_the_end());
      way.points.emplace_back(x, bits.on_the_way());
    }
    for (const auto& [x, bits] : turner) minors.points.emplace_back(x, bits.on_the_way());
    plot.curves.push_back(end);
    plot.curves.push_back(minors);
    if (suffix.empty()) plot.curves.push_back(way);
  }
};

// One point for each abscissa.
Comparison compared(const std::vector<double>& abscissas,
                    const std::function<Maker(double)>& maker_at, int matrices,
                    unsigned long seed) {
  Comparison result;
  for (const double x : abscissas) {
    const Maker make = maker_at(x);
    ++seed;
    result.gcd[x] = largest(make, Simplification::kGcd, matrices, seed);
    result.turner[x] = largest(make, Simplification::kTurner, matrices, seed);
  }
  return result;
}

std::vector<double> steps(double begin, double end, double step) {
  std::vector<double> result;
  for (int k = 0; begin + k * step <= end + step / 2; ++k) result.push_back(begin + k * step);
  return result;
}

// By the rank that the matrices turn out to have: sparse products rarely have all they could. A
// rank that is rarer than a tenth of `matrices` is left out: its largest entry would say nothing.
Comparison by_rank(int size, double density, int matrices, unsigned long seed) {
  std::map<int, int> met;
  Comparison result;
  for (int inner = 1; inner <= size; ++inner) {
    Random random(seed + static_cast<unsigned long>(inner));
    const Maker make = through(size, inner, density);
    for (int k = 0; k < matrices; ++k) {
      const IntegerMatrix matrix = make(random);
      const Measured gcd = measure(matrix, Simplification::kGcd);
      const Measured turner = measure(matrix, Simplification::kTurner);
      if (gcd.rank == 0) continue;
      ++met[gcd.rank];
      result.gcd[gcd.rank].raise(gcd.bits);
      result.turner[turner.rank].raise(turner.bits);
    }
  }
  for (const auto& [rank, count] : met) {
    if (count >= (matrices + 9) / 10) continue;
    result.gcd.erase(rank);
    result.turner.erase(rank);
  }
  return result;
}

NamedPlot comparison_plot(const std::string& name, const std::string& title,
                          const std::string& x_label, const Comparison& comparison) {
  Plot plot{title, x_label, kLargest, {}};
  comparison.add_to(plot);
  return {name, plot};
}

NamedPlot by_density_and_rank(int matrices) {
  Plot plot{"7.10  Sparse of bounded rank, 20 x 20", "density", kLargest, {}};
  for (const int inner : {5, 10, 15}) {
    compared(
        steps(0.1, 1.0, 0.1), [&](double density) { return through(20, inner, density); }, matrices,
        71000UL + 100UL * inner)
        .add_to(plot, ", r = " + std::to_string(inner));
  }
  return {"figure_7_10", plot};
}

}  // namespace

std::vector<NamedPlot> bit_growth_plots(int matrices) {
  const auto square = [](double density) {
    return [density](double m) { return full(static_cast<int>(m), static_cast<int>(m), density); };
  };
  std::vector<NamedPlot> plots = by_gcd(matrices);
  plots.insert(plots.begin(), without_simplification(matrices));
  std::vector<NamedPlot> comparisons{
      comparison_plot("figure_7_3", "7.3  Full rank, m x 20", kRows,
                      compared(
                          steps(1, 30, 1), [](double m) { return full(static_cast<int>(m), 20); },
                          matrices, 7300)),
      comparison_plot("figure_7_4", "7.4  Deficient rank, 20 x 20", "rank r",
                      by_rank(20, 1.0, matrices, 7400)),
      comparison_plot("figure_7_5", "7.5  Density 0.10, m = n", kRows,
                      compared(steps(2, 40, 2), square(0.10), matrices, 7500)),
      comparison_plot("figure_7_6", "7.6  Density 0.25, m = n", kRows,
                      compared(steps(2, 40, 2), square(0.25), matrices, 7600)),
      comparison_plot(
          "figure_7_7", "7.7  Sparse, 20 x 20", "density",
          compared(
              steps(0.05, 1.0, 0.05), [](double h) { return full(20, 20, h); }, matrices, 7700)),
      comparison_plot("figure_7_8", "7.8  Density 0.10, deficient rank, 20 x 20", "rank r",
                      by_rank(20, 0.10, matrices, 7800)),
      comparison_plot("figure_7_9", "7.9  Density 0.25, deficient rank, 20 x 20", "rank r",
                      by_rank(20, 0.25, matrices, 7900)),
      by_density_and_rank(matrices),
  };
  plots.insert(plots.end(), comparisons.begin(), comparisons.end());
  return plots;
}

}  // namespace figures
