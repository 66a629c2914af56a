// Measures updates that stay exact against the thesis' rational update and prints a Markdown table.
//
// usage: isochor_ecles_update [--quick]
//   --quick   small neighbourhoods only
// Exit status: 0 measured, 1 a result is wrong (nothing is printed for it), 2 usage.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/grid_editor.h"
#include "isochor/ecles/least_change.h"
#include "isochor/ecles/reference.h"
#include "machine.h"
#include "support/triangle_spline.h"
#include "timing.h"

namespace isochor::bench {
namespace {

using isochor::testing::TriangleSpline;
using isochor::testing::TriangleSplineOptions;

constexpr unsigned kGridBits = 44;
const Rational kMove(Integer(1), Integer(50));  // of the anchor, in lengths of the grid

struct Problem {
  ConstraintMatrix matrix;
  Selection selection;
  Analysis analysis;
};

Problem around_a_vertex(int radius) {
  TriangleSplineOptions options;
  options.columns = 20;
  options.rows = 25;
  const TriangleSpline spline(options);
  Problem problem{spline.matrix(), spline.neighbourhood(spline.vertex(10, 12), radius), {}};
  problem.analysis = analyse(problem.matrix, problem.selection);
  return problem;
}

std::vector<Rational> zeros(int count) { return std::vector<Rational>(static_cast<size_t>(count)); }

GridEditor editor_of(const Problem& problem) {
  return {problem.matrix, 5, kGridBits, {zeros(problem.matrix.parameters())}};
}

// The least change by the thesis' method, once, and its time; it must agree with ours.
double thesis_seconds(const Problem& problem, const std::vector<Rational>& expected) {
  const int n = problem.matrix.parameters(), m = problem.matrix.rows();
  const ReferenceEditor reference(problem.matrix, RationalMatrix(m, 1), RationalMatrix(n, 1),
                                  problem.selection);
  const int derived = static_cast<int>(problem.selection.derived.size());
  const double begin = thread_cpu_seconds();
  const auto solution = reference.update(RationalMatrix(1, 1, {kMove}), RationalMatrix(derived, 1));
  const double seconds = thread_cpu_seconds() - begin;
  for (int k = 0; k < derived; ++k) {
    if (!solution || solution->derived.at(k, 0) != expected[static_cast<size_t>(k)]) {
      throw std::runtime_error("the updates disagree");
    }
  }
  return seconds;
}

void print_row(int radius, const Patience& patience) {
  const Problem problem = around_a_vertex(radius);
  std::optional<GridEditor> editor(editor_of(problem));
  GridPlan plan;
  const double cold_begin = thread_cpu_seconds();
  plan = editor->initialize(problem.selection, problem.analysis);
  const double cold = thread_cpu_seconds() - cold_begin;
  const auto initialize = [&] { plan = editor->initialize(problem.selection, problem.analysis); };
  const double warm = best_cpu_seconds(initialize, patience);
  const std::vector<std::vector<double>> hints(
      1, std::vector<double>(problem.selection.derived.size()));
  GridUpdate last;
  const double update =
      best_cpu_seconds([&] { last = editor->update({{kMove}}, hints); }, patience);
  if (last.outcome != GridUpdate::Outcome::kDone) throw std::runtime_error(last.reason);
  for (int i = 0; i < problem.matrix.rows(); ++i)
    if (!editor->row_value(0, i).is_zero()) throw std::runtime_error("a constraint fails");

  const LeastChange least(problem.matrix, problem.selection.derived, problem.analysis.independent);
  std::vector<Rational> values = zeros(problem.matrix.parameters()), optimum;
  values[static_cast<size_t>(problem.selection.anchors[0])] = kMove;
  const double exact = best_cpu_seconds(
      [&] { optimum = least.solve(zeros(problem.matrix.rows()), values); }, {1, 0.0});
  const double thesis = thesis_seconds(problem, optimum);
  std::printf("| %d | %zu | %d | %.3g | %.3g | %.3g | 2^%.1f | 2^%.1f | %.3g | %.4g | %.0f |\n",
              radius, problem.selection.derived.size(), problem.analysis.rank(), 1e3 * cold,
              1e3 * warm, 1e6 * update, std::log2(plan.bound), std::log2(last.distance),
              1e3 * exact, 1e3 * thesis, thesis / update);
  std::fflush(stdout);
}

void run(bool quick) {
  std::printf("Machine: %s. Load average: %s.\nCompiler: %s.\n", processor_name().c_str(),
              load_average().c_str(), compiler_name().c_str());
  std::printf(
      "\n| radius | derived | rank | initialize, cold, ms | warm, ms | update, microseconds | "
      "bound "
      "| distance | exact optimum, ms | thesis' update, ms | ratio |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  const Patience patience{5, quick ? 0.01 : 0.3};
  for (const int radius : quick ? std::vector<int>{0, 1} : std::vector<int>{0, 3, 8})
    print_row(radius, patience);
}

}  // namespace
}  // namespace isochor::bench

int main(int argc, char** argv) {
  const bool quick = argc == 2 && std::strcmp(argv[1], "--quick") == 0;
  if (argc > 1 && !quick) {
    std::fprintf(stderr, "usage: isochor_ecles_update [--quick]\n");
    return 2;
  }
  try {
    isochor::bench::run(quick);
  } catch (const std::exception& fault) {
    std::fprintf(stderr, "isochor_ecles_update: %s\n", fault.what());
    return 1;
  }
  return 0;
}
