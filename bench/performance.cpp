// Measures the fast contraction against its baselines in one run and prints Markdown tables.
//
// usage: isochor_performance [--quick]
//   --quick   small sizes only; the slow OpenCASCADE call at the small size only
// Exit status: 0 measured, 1 a method gave a wrong result (nothing is printed for it), 2 usage.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fast.h"
#include "fma_peak.h"
#include "gauss_simd.h"
#include "machine.h"
#include "published.h"
#include "reference.h"
#include "timing.h"
#ifdef ISOCHOR_BENCH_OCCT
#include "isochor/volume/exact_volume.h"
#include "occt_volume.h"
#endif

namespace isochor::bench {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

// One method at one size. Not measured when `nanoseconds` is zero.
struct Measured {
  double nanoseconds = 0.0;  // per pole
  double error = 0.0;        // of the gradient, relative
};

struct Row {
  int degree = 0;
  int side = 0;
  Measured fast, plain, gauss, published, published_simd;
  double table = 0.0;  // nanoseconds per pole to fetch the poles and add the rows
};

void require_accuracy(const std::string& method, const Row& row, double error, double limit) {
  if (error <= limit) return;
  char text[200];
  std::snprintf(text, sizeof text, "%s, degree %d, %d x %d poles: relative error %.2g, not %.2g",
                method.c_str(), row.degree, row.side, row.side, error, limit);
  throw std::runtime_error(text);
}

Measured measure_fast(const PatchModel& model, const Reference& exact, const Row& row,
                      Instructions instructions, const Patience& patience) {
  const Fast fast(model, instructions);
  Measured result;
  result.error = relative_error(exact, fast.run(model.points).gradient);
  require_accuracy("fast contraction", row, result.error, 16.0 * kEps * row.side);
  ValueAndGradient sink;
  const double seconds = best_cpu_seconds([&] { fast.run(model.points, sink); }, patience);
  result.nanoseconds = 1e9 * seconds / (static_cast<double>(row.side) * row.side);
  return result;
}

Measured measure(const std::string& name, const GradientMethod& method, const PatchModel& model,
                 const Reference& exact, const Row& row, double limit, const Patience& patience) {
  const PatchGrid grid = patch_grid(model, 0);
  Columns areas;
  double seconds = best_cpu_seconds([&] { method.run(grid, areas); }, patience);
  Measured result;
  result.error = relative_error(exact, point_rows(model, 0, areas));
  require_accuracy(name, row, result.error, limit);
  result.nanoseconds = 1e9 * seconds / (static_cast<double>(row.side) * row.side);
  return result;
}

// What the fast contraction does besides computing, and the baselines are spared.
double measure_table(const PatchModel& model, const Row& row, const Patience& patience) {
  Columns columns;
  std::vector<Vec3> rows(model.points.size());
  const double seconds = best_cpu_seconds(
      [&] {
        gather_poles(model, 0, columns);
        std::fill(rows.begin(), rows.end(), Vec3::Zero());
        add_rows(model.patches[0], columns, rows);
      },
      patience);
  return 1e9 * seconds / (static_cast<double>(row.side) * row.side);
}

Row measure_row(int degree, int side) {
  Row row{degree, side, {}, {}, {}, {}, {}, 0.0};
  const PatchModel model = wavy_torus(degree, side);
  const Reference exact = reference(model);
  const PatchGrid grid = patch_grid(model, 0);
  const Patience patience{5, side < 300 ? 0.3 : 1.0};
  row.fast = measure_fast(model, exact, row, Instructions::kBest, patience);
  row.table = measure_table(model, row, patience);
  row.plain = measure_fast(model, exact, row, Instructions::kPlain, patience);
  row.gauss =
      measure("Gauss", *gauss_method(grid), model, exact, row, 64.0 * kEps * side, patience);
  // Absolute positions enter the published sums: their rounding grows with the square of the side.
  const double limit = 64.0 * kEps * side * side;
  const Patience few{side < 300 ? 3 : 2, 0.0};
  row.published =
      measure("published contraction", *published_method(grid), model, exact, row, limit, few);
  row.published_simd = measure("published contraction, vectorised", *published_method_simd(grid),
                               model, exact, row, limit, few);
  return row;
}

// Fused multiply-adds per pole of the contraction on differences.
int contraction_fmas(int d) { return 6 * (3 * d * d + d) + 12 * d * (2 * d + 1); }

std::string time_text(const Measured& measured) {
  if (measured.nanoseconds == 0.0) return "-";
  char text[40];
  std::snprintf(text, sizeof text, measured.nanoseconds < 100.0 ? "%.1f" : "%.0f",
                measured.nanoseconds);
  return text;
}

void print_head(double peak) {
  std::printf("Machine: %s. Load average: %s.\n", processor_name().c_str(), load_average().c_str());
  std::printf("Compiler: %s; kernels and baselines alike with `%s`.\n", compiler_name().c_str(),
              ISOCHOR_KERNEL_FLAGS);
  std::printf("Measured FMA peak of one thread: %.1f GFLOP/s.\n\n", peak);
}

void print_contraction_table(const std::vector<Row>& rows, double peak) {
  std::printf(
      "Volume and all gradients of one patch, nanoseconds per pole, one thread.\n\n"
      "| degree | poles | fast | in and out | fast, plain | Gauss | published | published, SIMD | "
      "Gauss / fast "
      "| published / fast | published, SIMD / fast | of FMA peak |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    const double fast = row.fast.nanoseconds;
    std::printf("| %d | %d x %d | %s | %.1f | %s | %s | %s | %s | %.2f | %.1f | %.1f | %.0f %% |\n",
                row.degree, row.side, row.side, time_text(row.fast).c_str(), row.table,
                time_text(row.plain).c_str(), time_text(row.gauss).c_str(),
                time_text(row.published).c_str(), time_text(row.published_simd).c_str(),
                row.gauss.nanoseconds / fast, row.published.nanoseconds / fast,
                row.published_simd.nanoseconds / fast,
                100.0 * 2.0 * contraction_fmas(row.degree) / (fast * peak));
  }
}

void print_error_table(const std::vector<Row>& rows) {
  std::printf(
      "\nLargest error of the gradient, relative to its largest entry.\n\n"
      "| degree | poles | fast | fast, plain | Gauss | published | 4 eps side |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Row& row : rows) {
    char plain[20] = "-";
    if (row.plain.nanoseconds != 0.0) std::snprintf(plain, sizeof plain, "%.1e", row.plain.error);
    std::printf("| %d | %d x %d | %.1e | %s | %.1e | %.1e | %.1e |\n", row.degree, row.side,
                row.side, row.fast.error, plain, row.gauss.error, row.published.error,
                4.0 * kEps * row.side);
  }
}

void print_threads(int side) {
  std::printf("\nThreads, degree 3, %d x %d poles: ", side, side);
  const PatchModel model = wavy_torus(3, side);
  const Patience patience{5, 0.5};
  std::vector<ValueAndGradient> results(3);
  std::vector<double> process(3), wall(3);
  for (int threads = 1; threads <= 3; ++threads) {
    const Fast fast(model, Instructions::kBest, threads);
    const auto work = [&] { fast.run(model.points, results[static_cast<size_t>(threads - 1)]); };
    process[static_cast<size_t>(threads - 1)] =
        best_seconds(CLOCK_PROCESS_CPUTIME_ID, work, patience) / threads;
    wall[static_cast<size_t>(threads - 1)] = best_seconds(CLOCK_MONOTONIC, work, patience);
    if (results[static_cast<size_t>(threads - 1)].value != results[0].value ||
        results[static_cast<size_t>(threads - 1)].gradient != results[0].gradient) {
      throw std::runtime_error("the result depends on the number of threads");
    }
  }
  std::printf(
      "%.2f ms of processor time on one thread, %.2f ms on each of two (%.2f times); "
      "%.2f and %.2f ms by the clock (%.2f times). Results identical to the bit for 1, 2 "
      "and 3 threads.\n",
      1e3 * process[0], 1e3 * process[1], process[0] / process[1], 1e3 * wall[0], 1e3 * wall[1],
      wall[0] / wall[1]);
}

#ifdef ISOCHOR_BENCH_OCCT
// What a volume costs and how wrong it is.
struct Answer {
  double seconds = 0.0;
  double error = 0.0;  // relative
};

template <typename Compute>
Answer answer(const Compute& compute, long double exact, double limit, const Patience& patience) {
  double value = 0.0;
  Answer result;
  result.seconds = best_cpu_seconds([&] { value = compute(); }, patience);
  result.error = static_cast<double>(std::fabs((value - exact) / exact));
  if (!(result.error <= limit)) throw std::runtime_error("a volume is wrong");
  return result;
}

// The volume as a rational number where that is quick, else in 80 bits.
long double exact_volume(const PatchModel& model) {
  if (model.points.size() > 10000) return reference(model).volume;
  return static_cast<long double>(ExactVolume(model).value(model.points).to_double());
}

void print_occt_row(int side, int ripples) {
  const PatchModel model = bent_cube(3, side, ripples);
  const long double exact = exact_volume(model);
  const Fast fast(model);
  ValueAndGradient ours;
  const Answer our = answer(
      [&] {
        fast.run(model.points, ours);
        return ours.value;
      },
      exact, 1e-12, {5, 0.5});
  const OcctSolid solid(model);
  const Answer plain = answer([&] { return solid.volume(); }, exact, 1e-3, {3, 0.0});
  const Answer adaptive = answer([&] { return solid.volume(1e-10); }, exact, 1e-3, {1, 0.0});
  std::printf("| 6 x %d x %d | %d | %.3f | %.1f | %.0f | %.0f | %.0f | %.1e | %.1e | %.1e |\n",
              side, side, ripples, 1e3 * our.seconds, 1e3 * plain.seconds,
              plain.seconds / our.seconds, 1e3 * adaptive.seconds, adaptive.seconds / our.seconds,
              our.error, plain.error, adaptive.error);
}

void print_occt_table(bool quick) {
  std::printf(
      "\nSolids of six bicubic faces, smooth or with ripples along each edge: ours is volume and "
      "all "
      "gradients, BRepGProp's the volume alone.\n\n"
      "| poles | ripples | ours, ms | default, ms | ratio | Eps = 1e-10, ms | ratio | error: ours "
      "| "
      "default | Eps = 1e-10 |\n|---|---|---|---|---|---|---|---|---|---|\n");
  const std::vector<std::pair<int, int>> all = {{8, 0}, {32, 0}, {32, 3}, {200, 0}, {200, 20}};
  for (const auto& [side, ripples] : all) {
    if ((side < 10) == quick) print_occt_row(side, ripples);
  }
}
#endif

void run(bool quick) {
  if (!has_fma()) throw std::runtime_error("the baselines need a processor with AVX2 and FMA");
  const double peak = fma_peak_gflops();
  print_head(peak);
  const std::vector<std::pair<int, int>> all = {{3, 32},  {3, 100},  {3, 316}, {3, 1000},
                                                {2, 100}, {2, 1000}, {5, 100}, {5, 1000}};
  std::vector<Row> rows;
  for (const auto& [degree, side] : all) {
    if (quick && side > 100) continue;
    rows.push_back(measure_row(degree, side));
  }
  print_contraction_table(rows, peak);
  print_error_table(rows);
  print_threads(quick ? 100 : 1000);
#ifdef ISOCHOR_BENCH_OCCT
  print_occt_table(quick);
#endif
}

}  // namespace
}  // namespace isochor::bench

int main(int argc, char** argv) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick) {
    std::fprintf(stderr, "usage: isochor_performance [--quick]\n");
    return 2;
  }
  try {
    isochor::bench::run(quick);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "isochor_performance: %s\n", fault.what());
    return 1;
  }
  return 0;
}
