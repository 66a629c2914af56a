#include <algorithm>

#include "commands.h"
#include "isochor/ecles/problem.h"
#include "isochor/ecles/problem_text.h"
#include "isochor/io/file.h"
#include "isochor/io/problem_json.h"
#include "terminal.h"

namespace isochor::app {
namespace {

constexpr size_t kMostLines = 40;

// An exact value while it is short, else its decimals.
std::string short_text(const Rational& number) {
  constexpr size_t kLongest = 20;
  const std::string text = number.to_string();
  return text.size() <= kLongest ? text : format("~%.12g", number.to_double());
}

std::string short_text(const RationalPoint& point) {
  std::string text;
  for (const Rational& number : point) text += (text.empty() ? "" : ", ") + short_text(number);
  return point.size() == 1 ? text : "(" + text + ")";
}

// Columns as wide as their widest entry.
void print_table(const Common& common, const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  for (const auto& row : rows) {
    std::string line;
    for (size_t k = 0; k < row.size(); ++k) {
      line += "  " + row[k];
      if (k + 1 < row.size()) line += std::string(widths[k] - row[k].size(), ' ');
    }
    print(common, line);
  }
}

// "and 7 more" after the lines that are shown.
void print_rest(const Common& common, size_t all) {
  if (all > kMostLines) {
    print(common, format("  ... and %zu more, in the solution file", all - kMostLines));
  }
}

void print_values(const Common& common, const Problem& problem, const Solution& solution) {
  std::vector<std::vector<std::string>> rows{{"parameter", "", "from", "to", ""}};
  const auto add = [&](int parameter, const char* role, const std::string& remark) {
    if (rows.size() > kMostLines) return;
    const auto j = static_cast<size_t>(parameter);
    rows.push_back({problem.parameters[j].name, role, short_text(problem.parameters[j].value),
                    short_text(solution.values[j]), remark});
  };
  for (const auto& anchor : problem.anchors) add(anchor.parameter, "anchor", "");
  for (const auto& each : problem.derived) {
    const bool kept = solution.values[static_cast<size_t>(each.parameter)] == each.hint;
    add(each.parameter, "derived", kept ? "" : "hint " + short_text(each.hint));
  }
  for (auto& row : rows) {
    if (row.back().empty()) row.pop_back();
  }
  print_table(common, rows);
  print_rest(common, problem.anchors.size() + problem.derived.size());
}

void print_violations(const Common& common, const Problem& problem, const Solution& solution) {
  const bool solved = solution.outcome == Solution::Outcome::kSolved;
  size_t shown = 0;
  for (const Violation& violation : solution.violated_before) {
    if (++shown > kMostLines) break;
    const std::string& name = problem.constraints[static_cast<size_t>(violation.constraint)].name;
    print(common, "violated at the start: " + name + ", by " + short_text(violation.residual) +
                      (!violation.relevant ? "; not relevant for this edit, so it stays violated"
                       : solved            ? "; repaired"
                                           : ""));
  }
  print_rest(common, solution.violated_before.size());
}

void print_summary(const Common& common, const Problem& problem, const Solution& solution) {
  if (solution.reason.empty()) print(common, headline(problem, solution));
  if (solution.outcome == Solution::Outcome::kSolved) print_values(common, problem, solution);
  size_t shown = 0;
  for (const Redundancy& each : solution.redundant) {
    if (++shown > kMostLines) break;
    print(common,
          "redundant, harmless: " + problem.constraints[static_cast<size_t>(each.constraint)].name +
              "; " + sentence(problem, each.because));
  }
  print_rest(common, solution.redundant.size());
  print_violations(common, problem, solution);
  if (solution.outcome == Solution::Outcome::kSolved && !solution.strongly_solvable) {
    print(common, "other values of the anchors could fail: " +
                      sentence(problem, solution.obstructions.front()));
  }
}

}  // namespace

int run_solve(const SolveOptions& options, const Common& common) {
  if (!options.output.empty()) require_writable(options.output);
  const ProblemFile file = parse_problem(read_file(options.problem), options.problem);
  for (const std::string& notice : file.notices) note(common, options.problem + ": " + notice);
  const Solution solution = solve(file.problem);
  const Value value = solution_value(file.problem, solution, file.notices);
  if (!options.output.empty()) write_file(options.output, to_json(value));
  print_summary(common, file.problem, solution);
  const bool solved = solution.outcome == Solution::Outcome::kSolved;
  if (!solution.reason.empty()) refuse(options.problem + ": refused: " + solution.reason);
  size_t shown = 0;
  for (const Combination& conflict : solution.conflicts) {
    if (++shown > kMostLines) break;
    refuse(options.problem + ": " + sentence(file.problem, conflict));
  }
  if (!options.output.empty()) print(common, "solution: " + options.output);
  print_json(common, value);
  return solved ? kExitDone : kExitNo;
}

}  // namespace isochor::app
