// Measures exact verdicts against the thesis' algorithm in one run and prints Markdown tables.
//
// usage: isochor_ecles_performance [--quick]
//   --quick   small systems only
// Exit status: 0 measured, 1 verdicts disagree or a proof fails (nothing is printed for it), 2
// usage.
#include <algorithm>
#include <cstdio>
#include <cstring>
#include <exception>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/index_map.h"
#include "isochor/ecles/ldu.h"
#include "isochor/ecles/proof.h"
#include "machine.h"
#include "support/triangle_spline.h"
#include "timing.h"

namespace isochor::bench {
namespace {

using isochor::testing::TriangleSpline;
using isochor::testing::TriangleSplineOptions;

struct Problem {
  std::string name;
  ConstraintMatrix matrix;
  Selection selection;
};

Problem random_dense(int size, int rank, int bits) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> entry(-(1 << bits) + 1, (1 << bits) - 1);
  std::vector<RationalTerms> rows;
  for (int i = 0; i < size; ++i) {
    rows.emplace_back();
    for (int j = 0; j < size; ++j) {
      if (i < rank) {
        rows.back().emplace_back(j, Rational(entry(random)));
      } else {  // the sum of two of the first
        rows.back().emplace_back(
            j, rows[static_cast<size_t>(i - rank)][static_cast<size_t>(j)].second +
                   rows[static_cast<size_t>(i - rank + 1)][static_cast<size_t>(j)].second);
      }
    }
  }
  Selection all;
  for (int j = 0; j < size; ++j) all.derived.push_back(j);
  return {"random dense, " + std::to_string(bits) + " bits, rank " + std::to_string(rank),
          ConstraintMatrix(size, rows), std::move(all)};
}

TriangleSpline spline_of(int triangles, int bits) {
  TriangleSplineOptions options;
  const int cells = triangles / 2;
  options.rows = 5;
  while (2 * options.rows * options.rows < cells || cells % options.rows != 0) options.rows += 5;
  options.columns = cells / options.rows;
  options.bits = bits;
  return TriangleSpline(options);
}

Problem around_a_vertex(int triangles, int radius, int bits) {
  const TriangleSpline spline = spline_of(triangles, bits);
  return {"C1 spline, " + std::to_string(bits) + " bits, radius " + std::to_string(radius),
          spline.matrix(), spline.neighbourhood(spline.middle(), radius)};
}

Problem whole_spline(int triangles, int bits) {
  const TriangleSpline spline = spline_of(triangles, bits);
  return {"C1 spline, " + std::to_string(bits) + " bits, " + std::to_string(spline.triangles()) +
              " triangles, all",
          spline.matrix(), spline.everything(spline.middle())};
}

double median_seconds(const Problem& problem) {
  std::vector<double> times;
  double total = 0.0;
  while (times.size() < 5 || (total < 0.5 && times.size() < 1000)) {
    const double begin = thread_cpu_seconds();
    const Analysis analysis = analyse(problem.matrix, problem.selection);
    times.push_back(thread_cpu_seconds() - begin);
    total += times.back();
  }
  const auto half = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), half, times.end());
  return *half;
}

// Dense, as the thesis has it; building it is not part of its time.
IntegerMatrix dense(const ConstraintMatrix& matrix, const std::vector<int>& rows,
                    const std::vector<int>& parameters) {
  const internal::IndexMap place(parameters);
  IntegerMatrix result(static_cast<int>(rows.size()), static_cast<int>(parameters.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const ConstraintTerm& term : matrix.row(rows[i])) {
      const int j = place[term.parameter];
      if (j != internal::IndexMap::kNone) result.set(static_cast<int>(i), j, term.coefficient);
    }
  }
  return result;
}

// Factoring and the test of strong solvability, once.
double thesis_seconds(const Problem& problem, const Analysis& analysis,
                      Simplification simplification) {
  IntegerMatrix derived = dense(problem.matrix, analysis.relevance.rows, problem.selection.derived);
  const RationalMatrix anchors(
      dense(problem.matrix, analysis.relevance.rows, problem.selection.anchors));
  const double begin = thread_cpu_seconds();
  const LduFactoring factoring = factor_ldu(std::move(derived), simplification);
  const bool solvable = reaches(factoring, anchors);
  const double seconds = thread_cpu_seconds() - begin;
  if (factoring.rank() != analysis.rank() || solvable != analysis.strongly_solvable()) {
    throw std::runtime_error(problem.name + ": the verdicts disagree");
  }
  return seconds;
}

Analysis proven(const Problem& problem) {
  Analysis analysis = analyse(problem.matrix, problem.selection);
  if (!verify(analysis, problem.matrix, problem.selection)) {
    throw std::runtime_error(problem.name + ": the proof fails");
  }
  return analysis;
}

void print_comparison(const std::vector<Problem>& problems) {
  std::printf(
      "\nVerdict and proof. Ratio: the faster variant of the thesis over ours.\n\n"
      "| system | size | rank | thesis, GCD, ms | thesis, Turner, ms | ours, ms | ratio |\n"
      "|---|---|---|---|---|---|---|\n");
  for (const Problem& problem : problems) {
    const Analysis analysis = proven(problem);
    const double fast = median_seconds(problem);
    const double gcd = thesis_seconds(problem, analysis, Simplification::kGcd);
    const double turner = thesis_seconds(problem, analysis, Simplification::kTurner);
    std::printf("| %s | %zu x %zu | %d | %.4g | %.4g | %.3g | %.0f |\n", problem.name.c_str(),
                analysis.relevance.rows.size(), problem.selection.derived.size(), analysis.rank(),
                1e3 * gcd, 1e3 * turner, 1e3 * fast, std::min(gcd, turner) / fast);
    std::fflush(stdout);
  }
}

void print_growth(const std::vector<int>& sizes, const std::vector<int>& bits) {
  std::printf(
      "\nGrowth with the model, everything derived, ours alone.\n\n"
      "| system | size | rank | circuits | ours, ms | microseconds a triangle |\n"
      "|---|---|---|---|---|---|\n");
  for (const int b : bits) {
    for (const int triangles : sizes) {
      const Problem problem = whole_spline(triangles, b);
      const Analysis analysis = proven(problem);
      const double fast = median_seconds(problem);
      std::printf("| %s | %zu x %zu | %d | %zu | %.3g | %.2f |\n", problem.name.c_str(),
                  analysis.relevance.rows.size(), problem.selection.derived.size(), analysis.rank(),
                  analysis.circuits.size(), 1e3 * fast, 1e6 * fast / triangles);
      std::fflush(stdout);
    }
  }
}

// The same edit, around the vertex at the same place of meshes that agree there.
void print_local_work(const std::vector<int>& sides) {
  std::printf(
      "\nOne local edit, radius 8, in models of two sizes: what it touches.\n\n"
      "| triangles | rows | nonzeros | pivots | ms |\n"
      "|---|---|---|---|---|\n");
  for (const int side : sides) {
    TriangleSplineOptions options;
    options.columns = 4 * side;
    options.rows = 5 * side;
    options.cell = (1 << 12) / 25;
    const TriangleSpline spline(options);
    const Problem problem{"local edit", spline.matrix(),
                          spline.neighbourhood(spline.vertex(10, 12), 8)};
    const Analysis analysis = analyse(problem.matrix, problem.selection);
    std::printf("| %d | %zu | %zu | %zu | %.3g |\n", spline.triangles(), analysis.work.rows,
                analysis.work.nonzeros, analysis.work.pivots, 1e3 * median_seconds(problem));
    std::fflush(stdout);
  }
}

void run(bool quick) {
  std::printf("Machine: %s. Load average: %s.\nCompiler: %s.\n", processor_name().c_str(),
              load_average().c_str(), compiler_name().c_str());
  std::vector<Problem> problems;
  problems.push_back(random_dense(quick ? 60 : 200, quick ? 60 : 200, 10));
  problems.push_back(random_dense(quick ? 60 : 200, quick ? 55 : 190, 10));
  problems.push_back(around_a_vertex(1000, 0, 12));
  problems.push_back(around_a_vertex(1000, 3, 12));
  if (!quick) {
    problems.push_back(around_a_vertex(1000, 8, 12));
    problems.push_back(around_a_vertex(1000, 8, 53));
    problems.push_back(whole_spline(100, 12));
  }
  print_comparison(problems);
  print_growth(quick ? std::vector<int>{100} : std::vector<int>{100, 1000, 10000}, {12, 53});
  print_local_work(quick ? std::vector<int>{5} : std::vector<int>{5, 50});
}

}  // namespace
}  // namespace isochor::bench

int main(int argc, char** argv) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick) {
    std::fprintf(stderr, "usage: isochor_ecles_performance [--quick]\n");
    return 2;
  }
  try {
    isochor::bench::run(quick);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "isochor_ecles_performance: %s\n", fault.what());
    return 1;
  }
  return 0;
}
