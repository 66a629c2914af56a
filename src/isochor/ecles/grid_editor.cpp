#include "isochor/ecles/grid_editor.h"

#include <algorithm>
#include <cmath>

#include "isochor/base/double_double.h"
#include "isochor/base/error.h"
#include "isochor/base/tolerance.h"
#include "isochor/ecles/index_map.h"
#include "isochor/ecles/lattice_blocks.h"
#include "isochor/ecles/least_change.h"

namespace isochor {
namespace {

using internal::Wide;

constexpr long kLargestMove = 1L << 53;  // units: anchors' moves are exact in doubles

Integer to_integer(Wide value) {
  if (value == static_cast<long>(value)) return {static_cast<long>(value)};
  const auto low = static_cast<long>(value & ((Wide{1} << 62) - 1));
  return to_integer(value >> 62).shifted(62) + Integer(low);
}

// A relevant row on A (positions from 0) and D (positions from |A|).
struct FollowedRow {
  int row = 0;
  bool words = true;
  std::vector<std::pair<int, long>> terms;
  std::vector<std::pair<int, Integer>> long_terms;  // instead of terms where these do not fit
};

std::vector<FollowedRow> followed_rows(const ConstraintMatrix& matrix, const Selection& selection,
                                       const std::vector<int>& rows) {
  std::vector<int> chosen = selection.anchors;
  chosen.insert(chosen.end(), selection.derived.begin(), selection.derived.end());
  const internal::IndexMap position(chosen);
  std::vector<FollowedRow> result;
  for (const int i : rows) {
    FollowedRow row;
    row.row = i;
    for (const ConstraintTerm& term : matrix.row(i)) {
      const int at = position[term.parameter];
      if (at < 0) continue;
      const auto word = term.coefficient.to_long();
      row.words = row.words && word;
      if (word) row.terms.emplace_back(at, *word);
      row.long_terms.emplace_back(at, term.coefficient);
    }
    if (row.words) row.long_terms.clear();
    result.push_back(std::move(row));
  }
  return result;
}

std::string count_text(const Rational& value) {
  return value.denominator() == Integer(1) ? value.to_string()
                                           : "the fraction " + value.to_string();
}

std::string obstacle_text(const GridObstacle& obstacle) {
  std::string rows;
  for (const int row : obstacle.rows) rows += (rows.empty() ? "" : ", ") + std::to_string(row);
  return "component " + std::to_string(obstacle.component) +
         ": the anchors' moves need the combination of rows {" + rows +
         "} to be an integer, it is " + obstacle.value.to_string() + "; only moves that " +
         obstacle.value.denominator().to_string() + " divides there are on the grid" +
         (obstacle.restricted ? " (as far as the divided component can tell)" : "");
}

}  // namespace

struct GridEditor::Job {
  Selection selection;
  GridOptions options;
  LeastChange optimum;
  internal::LatticeBlocks blocks;
  std::vector<FollowedRow> rows;
  double unit = 0.0;
  double bound = 0.0;     // in units
  DoubleDouble per_unit;  // 1 / unit
  // The base: numbers and rests of A, then D, by component.
  std::vector<std::vector<long>> numbers;
  std::vector<std::vector<Rational>> rests;
  std::vector<int> loose;  // parameters
  std::optional<LeastChange> loose_optimum;
};

struct GridEditor::Move {
  int component = 0;
  std::vector<Wide> z, x;
  std::vector<Rational> loose;  // increments, in the order of blocks.loose()
};

GridEditor::GridEditor(ConstraintMatrix matrix, const Integer& denominator, unsigned bits,
                       const std::vector<std::vector<Rational>>& values)
    : matrix_(std::move(matrix)),
      rests_(values.size()),
      zero_rows_(static_cast<size_t>(matrix_.rows())),
      increments_(static_cast<size_t>(matrix_.parameters())),
      cache_(std::make_shared<internal::LatticeCache>()) {
  ISOCHOR_REQUIRE(denominator.sign() > 0, denominator.to_string());
  unit_ = Rational(Integer(1), denominator.shifted(bits));
  for (const auto& component : values) {
    ISOCHOR_REQUIRE(component.size() == increments_.size(), component.size());
    numbers_.emplace_back();
    for (size_t j = 0; j < component.size(); ++j) {
      const Rational number = component[j] / unit_;
      const std::string entity = "parameter " + std::to_string(j);
      if (number.denominator() != Integer(1))
        throw InputError("", entity,
                         component[j].to_string() + " is not a multiple of the grid's unit " +
                             unit_.to_string());
      const auto word = number.numerator().to_long();
      if (!word)
        throw InputError(
            "", entity,
            component[j].to_string() + " is " + number.to_string() + " units, beyond 64 bits");
      numbers_.back().push_back(*word);
    }
  }
}

long GridEditor::number(int component, int parameter) const {
  return numbers_.at(static_cast<size_t>(component)).at(static_cast<size_t>(parameter));
}

Rational GridEditor::rest(int component, int parameter) const {
  const auto& rests = rests_.at(static_cast<size_t>(component));
  const auto found = rests.find(parameter);
  return found == rests.end() ? Rational() : found->second;
}

Rational GridEditor::exact_number(int component, int parameter) const {
  return Rational(number(component, parameter)) + rest(component, parameter);
}

Rational GridEditor::value(int component, int parameter) const {
  return exact_number(component, parameter) * unit_;
}

Rational GridEditor::row_value(int component, int row) const {
  Integer sum;
  Rational rests;
  for (const ConstraintTerm& term : matrix_.row(row)) {
    sum.add_product(term.coefficient, number(component, term.parameter));
    if (!rests_[static_cast<size_t>(component)].empty())
      rests += Rational(term.coefficient) * rest(component, term.parameter);
  }
  return (Rational(sum) + rests) * unit_;
}

GridPlan GridEditor::initialize(const Selection& selection, const Analysis& analysis,
                                const GridOptions& options) {
  std::vector<double>
      weights;  // relative to the smallest, so that they fit doubles or are infinite
  if (!options.weights.empty()) {
    const Rational least = *std::min_element(options.weights.begin(), options.weights.end());
    ISOCHOR_REQUIRE(least.sign() > 0, least.to_string());
    for (const Rational& weight : options.weights) weights.push_back((weight / least).to_double());
  }
  LeastChange optimum(matrix_, selection.derived, analysis.independent, options.weights);
  internal::LatticeBlocks blocks(
      matrix_, selection, analysis.independent, weights,
      {options.largest_block, options.largest_rounding / unit_.to_double()}, *cache_);
  auto job = std::make_shared<Job>(Job{selection,
                                       options,
                                       std::move(optimum),
                                       std::move(blocks),
                                       followed_rows(matrix_, selection, analysis.relevance.rows),
                                       unit_.to_double(),
                                       0.0,
                                       DoubleDouble(),
                                       {},
                                       {},
                                       {},
                                       {}});
  const Rational per_unit = Rational(1) / unit_;
  job->per_unit = DoubleDouble(per_unit.to_double()) +
                  DoubleDouble((per_unit - Rational(per_unit.to_double())).to_double());
  for (int c = 0; c < components(); ++c) {
    job->numbers.emplace_back();
    job->rests.emplace_back();
    for (const auto* list : {&selection.anchors, &selection.derived})
      for (const int j : *list) {
        job->numbers.back().push_back(number(c, j));
        job->rests.back().push_back(rest(c, j));
      }
  }
  for (const double bound : job->blocks.bound()) job->bound = std::max(job->bound, bound);
  std::vector<Rational> loose_weights;
  for (const int k : job->blocks.loose()) {
    job->loose.push_back(selection.derived[static_cast<size_t>(k)]);
    if (!weights.empty()) loose_weights.push_back(options.weights[static_cast<size_t>(k)]);
  }
  if (!job->loose.empty())
    job->loose_optimum.emplace(matrix_, job->loose, job->blocks.loose_rows(), loose_weights);
  GridPlan plan;
  plan.blocks = static_cast<int>(job->blocks.blocks().size());
  plan.free_parameters = static_cast<int>(job->blocks.free().size());
  plan.loose = job->loose;
  plan.restricted = job->blocks.restricted();
  plan.bound = job->bound * job->unit;
  job_ = std::move(job);
  return plan;
}

// The anchors' moves in units: targets, then snapped.
bool GridEditor::move_anchors(const std::vector<Rational>& targets, Move& move,
                              GridUpdate& report) const {
  const Job& job = *job_;
  const size_t count = job.selection.anchors.size();
  ISOCHOR_REQUIRE(targets.size() == count, targets.size(), count);
  const auto c = static_cast<size_t>(move.component);
  std::vector<long> wanted;
  bool exact = true;
  for (size_t k = 0; k < count; ++k) {
    const Rational moved = targets[k] / unit_ - Rational(job.numbers[c][k]) - job.rests[c][k];
    const std::string name = "component " + std::to_string(c) + ", parameter " +
                             std::to_string(job.selection.anchors[k]) + ": ";
    if (moved.denominator() != Integer(1) && job.options.policy == AnchorPolicy::kRequireExact) {
      report.outcome = GridUpdate::Outcome::kAnchorOffGrid;
      report.reason = name + "the target " + targets[k].to_string() +
                      " is not on the grid of unit " + unit_.to_string();
      return false;
    }
    const auto word = moved.numerator().divided_nearest(moved.denominator()).to_long();
    if (!word || *word > kLargestMove || *word < -kLargestMove) {
      report.outcome = GridUpdate::Outcome::kTooLarge;
      report.reason =
          name + "the target " + targets[k].to_string() + " is more than 2^53 units away";
      return false;
    }
    wanted.push_back(*word);
  }
  if (!job.blocks.anchors().nearest(wanted, move.z)) {
    report.outcome = GridUpdate::Outcome::kTooLarge;
    report.reason =
        "component " + std::to_string(c) + ": the admissible moves of the anchors leave 64 bits";
    return false;
  }
  report.anchors.emplace_back();
  for (size_t k = 0; k < count; ++k) {
    exact = exact && move.z[k] == wanted[k];
    const Rational used =
        (Rational(job.numbers[c][k]) + job.rests[c][k] + Rational(to_integer(move.z[k]))) * unit_;
    report.deviation = std::max(report.deviation, (used - targets[k]).abs().enclosure().high);
    report.anchors.back().push_back(used);
  }
  if (exact || job.options.policy == AnchorPolicy::kSnap) return true;
  report.outcome = GridUpdate::Outcome::kNoGridSolution;
  const auto obstacle = job.blocks.obstacle({wanted.begin(), wanted.end()});
  ISOCHOR_REQUIRE(obstacle, "a move outside the lattice has an obstacle");
  report.obstacle = {move.component, obstacle->rows, obstacle->proof.multipliers,
                     obstacle->proof.value, obstacle->restricted};
  report.reason = obstacle_text(report.obstacle);
  return false;
}

// The optimum in doubles, in units from the base; then the lattice.
bool GridEditor::move_derived(const std::vector<double>& hints, Move& move, GridUpdate& report) {
  const Job& job = *job_;
  const auto& [anchors, derived] = job.selection;
  ISOCHOR_REQUIRE(hints.size() == derived.size(), hints.size(), derived.size());
  const auto c = static_cast<size_t>(move.component);
  double largest = 0.0;
  for (size_t k = 0; k < derived.size(); ++k) {
    ISOCHOR_REQUIRE(std::isfinite(hints[k]), k, hints[k]);
    const size_t at = anchors.size() + k;
    const long base = job.numbers[c][at];
    const DoubleDouble base_number = DoubleDouble(static_cast<double>(base >> 32) * 0x1p32) +
                                     DoubleDouble(static_cast<double>(base & 0xffffffffL)) +
                                     DoubleDouble(job.rests[c][at].to_double());
    const double hint = (DoubleDouble(hints[k]) * job.per_unit - base_number).high();
    increments_[static_cast<size_t>(derived[k])] = hint;
    largest = std::max(largest, std::fabs(hint));
  }
  for (size_t k = 0; k < anchors.size(); ++k)
    increments_[static_cast<size_t>(anchors[k])] = static_cast<double>(move.z[k]);
  const LeastChange::Approximation optimum = job.optimum.approximate(zero_rows_, increments_);
  for (const auto* list : {&anchors, &derived})
    for (const int j : *list) increments_[static_cast<size_t>(j)] = 0.0;
  const bool rounded = job.blocks.nearest(move.z, optimum.derived, move.x);
  if (!rounded) {
    report.outcome = GridUpdate::Outcome::kTooLarge;
    report.reason = "component " + std::to_string(c) + ": intermediate numbers leave 128 bits";
    return false;
  }
  move_loose(hints, move);
  std::vector<double> moved(move.x.begin(), move.x.end());
  for (size_t k = 0; k < move.loose.size(); ++k)
    moved[static_cast<size_t>(job.blocks.loose()[k])] = move.loose[k].to_double();
  double distance = 0.0;
  for (size_t k = 0; k < moved.size(); ++k)
    distance = std::max(distance, std::fabs(moved[k] - optimum.derived[k]));
  // Hints were rounded once; the optimum depends on them by a projection.
  const double slack = optimum.last_change +
                       4 * kUnitRoundoff * largest * std::sqrt(static_cast<double>(hints.size()));
  report.distance = std::max(report.distance, (distance + slack) * job.unit);
  report.bound = std::max(report.bound, (job.bound + slack) * job.unit);
  return true;
}

// Loose parameters: the exact least change given all others.
void GridEditor::move_loose(const std::vector<double>& hints, Move& move) const {
  const Job& job = *job_;
  if (!job.loose_optimum) return;
  const auto& [anchors, derived] = job.selection;
  const auto c = static_cast<size_t>(move.component);
  std::vector<Rational> values(increments_.size());
  for (size_t k = 0; k < anchors.size(); ++k)
    values[static_cast<size_t>(anchors[k])] = Rational(to_integer(move.z[k]));
  for (size_t k = 0; k < derived.size(); ++k)
    values[static_cast<size_t>(derived[k])] = Rational(to_integer(move.x[k]));
  for (const int k : job.blocks.loose()) {
    const size_t at = anchors.size() + static_cast<size_t>(k);
    values[static_cast<size_t>(derived[static_cast<size_t>(k)])] =
        Rational(hints[static_cast<size_t>(k)]) / unit_ - Rational(job.numbers[c][at]) -
        job.rests[c][at];
  }
  move.loose = job.loose_optimum->solve(std::vector<Rational>(zero_rows_.size()), values);
}

// Every relevant row keeps its value, and every number fits. Exact, for each update.
bool GridEditor::check(const Move& move, GridUpdate& report) const {
  const Job& job = *job_;
  const auto c = static_cast<size_t>(move.component);
  const size_t anchors = job.selection.anchors.size();
  std::vector<Wide> moved = move.z;
  moved.insert(moved.end(), move.x.begin(), move.x.end());
  std::vector<const Rational*> loose(moved.size(), nullptr);
  for (size_t k = 0; k < move.loose.size(); ++k)
    loose[anchors + static_cast<size_t>(job.blocks.loose()[k])] = &move.loose[k];
  for (const FollowedRow& row : job.rows) {
    Wide sum = 0;
    bool fits = row.words;
    for (size_t t = 0; fits && t < row.terms.size(); ++t) {
      const auto& [at, coefficient] = row.terms[t];
      fits = !loose[static_cast<size_t>(at)] &&
             internal::add_product(sum, moved[static_cast<size_t>(at)], coefficient);
    }
    if (fits && sum == 0) continue;
    Rational exact;
    const auto add = [&](int at, const Integer& coefficient) {
      const auto k = static_cast<size_t>(at);
      exact += Rational(coefficient) * (loose[k] ? *loose[k] : Rational(to_integer(moved[k])));
    };
    for (const auto& [at, coefficient] : row.terms)
      if (row.words) add(at, coefficient);
    for (const auto& [at, coefficient] : row.long_terms) add(at, coefficient);
    if (exact.is_zero()) continue;
    report.outcome = GridUpdate::Outcome::kNotSolvable;
    report.reason = "component " + std::to_string(c) + ": row " + std::to_string(row.row) +
                    " cannot follow the anchors: its value would change by " + count_text(exact) +
                    " units";
    return false;
  }
  for (size_t at = 0; at < moved.size(); ++at) {
    Wide sum = job.numbers[c][at];
    const bool fits = internal::add_product(sum, moved[at], 1);
    if (!loose[at] && fits && sum == static_cast<long>(sum)) continue;
    const Rational number = Rational(job.numbers[c][at]) + job.rests[c][at] +
                            (loose[at] ? *loose[at] : Rational(to_integer(moved[at])));
    const Integer whole = number.numerator().divided_floor(number.denominator());
    if (whole.to_long()) continue;
    const int parameter =
        at < anchors ? job.selection.anchors[at] : job.selection.derived[at - anchors];
    report.outcome = GridUpdate::Outcome::kTooLarge;
    report.reason = "component " + std::to_string(c) + ", parameter " + std::to_string(parameter) +
                    ": " + whole.to_string() + " units leave 64 bits";
    return false;
  }
  return true;
}

void GridEditor::apply(const Move& move) {
  const Job& job = *job_;
  const auto c = static_cast<size_t>(move.component);
  const size_t anchors = job.selection.anchors.size();
  for (size_t k = 0; k < anchors; ++k)
    numbers_[c][static_cast<size_t>(job.selection.anchors[k])] =
        job.numbers[c][k] + static_cast<long>(move.z[k]);
  for (size_t k = 0; k < move.x.size(); ++k)
    numbers_[c][static_cast<size_t>(job.selection.derived[k])] =
        job.numbers[c][anchors + k] + static_cast<long>(move.x[k]);
  for (size_t k = 0; k < move.loose.size(); ++k) {
    const size_t at = anchors + static_cast<size_t>(job.blocks.loose()[k]);
    const Rational exact = Rational(job.numbers[c][at]) + job.rests[c][at] + move.loose[k];
    const Integer whole = exact.numerator().divided_floor(exact.denominator());
    numbers_[c][static_cast<size_t>(job.loose[k])] = *whole.to_long();
    const Rational rest = exact - Rational(whole);
    if (rest.is_zero())
      rests_[c].erase(job.loose[k]);
    else
      rests_[c][job.loose[k]] = rest;
  }
}

GridUpdate GridEditor::update(const std::vector<std::vector<Rational>>& targets,
                              const std::vector<std::vector<double>>& hints) {
  ISOCHOR_REQUIRE(job_, "update before initialize");
  ISOCHOR_REQUIRE(targets.size() == numbers_.size() && hints.size() == numbers_.size(),
                  targets.size(), hints.size());
  GridUpdate report;
  std::vector<Move> moves(numbers_.size());
  for (size_t c = 0; c < moves.size(); ++c) {
    moves[c].component = static_cast<int>(c);
    if (!move_anchors(targets[c], moves[c], report) || !move_derived(hints[c], moves[c], report) ||
        !check(moves[c], report))
      return report;
  }
  for (const Move& move : moves) apply(move);
  return report;
}

void GridEditor::cancel() {
  ISOCHOR_REQUIRE(job_, "cancel before initialize");
  for (int c = 0; c < components(); ++c) {
    const auto at = static_cast<size_t>(c);
    size_t k = 0;
    for (const auto* list : {&job_->selection.anchors, &job_->selection.derived})
      for (const int j : *list) {
        numbers_[at][static_cast<size_t>(j)] = job_->numbers[at][k];
        if (job_->rests[at][k].is_zero())
          rests_[at].erase(j);
        else
          rests_[at][j] = job_->rests[at][k];
        ++k;
      }
  }
}

}  // namespace isochor
