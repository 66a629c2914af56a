#include "isochor/ecles/problem_text.h"

#include <algorithm>

namespace isochor {
namespace {

constexpr size_t kLongestList = 8;

const std::string& name_at(const Problem& problem, int parameter) {
  return problem.parameters[static_cast<size_t>(parameter)].name;
}

std::string counted(size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

// "a", "a and b", "a, b and 7 more".
std::string listed(const std::vector<std::string>& names) {
  const size_t shown = names.size() <= kLongestList ? names.size() : kLongestList - 1;
  std::string text;
  for (size_t k = 0; k < shown; ++k) {
    const bool last = k + 1 == names.size();
    text += (k == 0 ? "" : last ? " and " : ", ") + names[k];
  }
  return shown == names.size() ? text
                               : text + " and " + std::to_string(names.size() - shown) + " more";
}

// "1 x join - 2 x offset", "1 p1 + 2 p2": coefficients, `times`, names.
std::string sum_of(const std::vector<std::pair<std::string, Rational>>& terms,
                   const std::string& times) {
  std::string text;
  for (size_t k = 0; k < terms.size(); ++k) {
    if (k == kLongestList) return text + " + ...";
    const auto& [name, coefficient] = terms[k];
    const std::string sign = coefficient.sign() < 0 ? "-" : k == 0 ? "" : "+";
    const std::string magnitude = coefficient.abs().to_string();
    text += (k == 0 ? "" : " ") + sign + (k == 0 ? "" : " ") + magnitude;
    text += times + name;
  }
  return text;
}

std::vector<std::string> names_of(const std::vector<std::pair<std::string, Rational>>& terms) {
  std::vector<std::string> names;
  for (const auto& term : terms) names.push_back(term.first);
  return names;
}

// What the anchors' part of a combination adds up to at their new values.
RationalPoint at_new_values(const Problem& problem, const Combination& combination) {
  RationalPoint sum(combination.residual.size());
  for (const auto& [parameter, coefficient] : combination.anchors) {
    const auto anchor = std::find_if(problem.anchors.begin(), problem.anchors.end(),
                                     [j = parameter](const auto& a) { return a.parameter == j; });
    if (anchor == problem.anchors.end()) continue;
    for (size_t c = 0; c < sum.size(); ++c) sum[c] += coefficient * anchor->value[c];
  }
  return sum;
}

}  // namespace

std::string text_of(const RationalPoint& point) {
  if (point.size() == 1) return point[0].to_string();
  std::string text;
  for (const Rational& number : point) text += (text.empty() ? "" : ", ") + number.to_string();
  return "(" + text + ")";
}

std::string sentence(const Problem& problem, const Combination& combination) {
  std::vector<std::pair<std::string, Rational>> sum, left;
  for (const auto& [i, multiplier] : combination.multipliers) {
    sum.emplace_back(problem.constraints[static_cast<size_t>(i)].name, multiplier);
  }
  for (const auto& [j, coefficient] : combination.anchors) {
    left.emplace_back(name_at(problem, j), coefficient);
  }
  const std::string who = listed(names_of(sum)), total = sum_of(sum, " x ") + " reads ";
  const std::string zero = text_of(RationalPoint(combination.residual.size()));
  const bool alone = sum.size() == 1;
  if (!left.empty()) {
    const RationalPoint is = at_new_values(problem, combination);
    RationalPoint must_be = combination.residual;
    for (size_t c = 0; c < is.size(); ++c) must_be[c] += is[c];
    const std::string relation = total + sum_of(left, " ") + " = " + text_of(must_be);
    if (combination.contradicts()) {
      return who + (alone ? " does" : " do") + " not allow the new " + listed(names_of(left)) +
             ": " + relation + ", but it is " + text_of(is);
    }
    return who + (alone ? " binds " : " bind ") + listed(names_of(left)) + ": " + relation +
           " whatever the derived parameters are";
  }
  if (combination.contradicts()) {
    return who + (alone ? " cannot hold: " : " contradict each other: ") + total + zero + " = " +
           text_of(combination.residual);
  }
  return who + (alone ? " says nothing" : " say the same more than once") +
         " about the derived parameters: " + total + zero + " = " + zero;
}

std::string headline(const Problem& problem, const Solution& solution) {
  const std::string constraints = counted(solution.relevant.size(), "relevant constraint");
  switch (solution.outcome) {
    case Solution::Outcome::kSolved:
      return "solved: " + counted(problem.anchors.size(), "anchor") + " and " +
             counted(problem.derived.size(), "derived parameter") + " fulfil " + constraints +
             " exactly (rank " + std::to_string(solution.rank) + ", freedom left " +
             std::to_string(solution.freedom_left) + ")";
    case Solution::Outcome::kNotWeaklySolvable:
      return "not weakly solvable: no values of the derived parameters fulfil the " + constraints +
             " (rank " + std::to_string(solution.rank) + ")";
    case Solution::Outcome::kNotStronglySolvable:
      return "not strongly solvable: some values of the anchors could not be served (" +
             constraints + ", rank " + std::to_string(solution.rank) + ")";
    case Solution::Outcome::kRefused:
      return "refused: " + solution.reason;
  }
  return "";
}

}  // namespace isochor
