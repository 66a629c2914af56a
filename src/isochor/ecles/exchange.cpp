#include "isochor/ecles/exchange.h"

#include <algorithm>
#include <unordered_map>

namespace isochor::internal {
namespace {

size_t index(int i) { return static_cast<size_t>(i); }

const Integer* multiplier_of(const Relation& relation, int row) {
  for (const auto& term : relation) {
    if (term.first == row) return &term.second;
  }
  return nullptr;
}

// The combination of both that does not involve the row.
Relation eliminated(const Relation& relation, const Relation& by, int row) {
  const Integer factor = *multiplier_of(by, row), by_factor = -*multiplier_of(relation, row);
  std::unordered_map<int, Integer> sums;
  for (const auto& term : relation) sums[term.first].add_product(term.second, factor);
  for (const auto& term : by) sums[term.first].add_product(term.second, by_factor);
  Relation result;
  Integer content;
  for (auto& term : sums) {
    if (term.second.is_zero()) continue;
    content = gcd(content, term.second);
    result.emplace_back(term.first, std::move(term.second));
  }
  for (auto& term : result) term.second = term.second.divided_exactly(content);
  return result;
}

}  // namespace

void exchange_to_first(const std::vector<int>& order, std::vector<DependentRow>& dependents,
                       std::vector<int>& basis) {
  std::vector<int> place(order.size());
  for (size_t k = 0; k < order.size(); ++k) place[index(order[k])] = static_cast<int>(k);
  for (DependentRow& dependent : dependents) {
    const auto last = std::max_element(dependent.relation.begin(), dependent.relation.end(),
                                       [&](const auto& a, const auto& b) {
                                         return place[index(a.first)] < place[index(b.first)];
                                       });
    const int member = last->first;
    if (member == dependent.row) continue;
    std::replace(basis.begin(), basis.end(), member, dependent.row);
    dependent.row = member;
    for (DependentRow& other : dependents) {
      if (&other != &dependent && multiplier_of(other.relation, member) != nullptr) {
        other.relation = eliminated(other.relation, dependent.relation, member);
      }
    }
  }
}

}  // namespace isochor::internal
