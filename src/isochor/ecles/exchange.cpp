#include "isochor/ecles/exchange.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "isochor/ecles/index_map.h"

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

// a - (a_row / b_row) b.
ModularRelation eliminated(const PrimeField& field, const ModularRelation& a,
                           const ModularRelation& b, Residue a_row, Residue b_row) {
  const PrimeField::Factor factor =
      field.factor(field.negative(field.multiply(a_row, field.inverse(b_row))));
  ModularRelation result;
  auto in_a = a.begin();
  for (const auto& [row, value] : b) {
    for (; in_a != a.end() && in_a->first < row; ++in_a) result.push_back(*in_a);
    Residue sum = field.multiply(value, factor);
    if (in_a != a.end() && in_a->first == row) sum = field.add(sum, (in_a++)->second);
    if (sum != 0) result.emplace_back(row, sum);
  }
  result.insert(result.end(), in_a, a.end());
  return result;
}

Residue coefficient_of(const ModularRelation& relation, int row) {
  const auto found =
      std::lower_bound(relation.begin(), relation.end(), std::make_pair(row, Residue{0}));
  return found != relation.end() && found->first == row ? found->second : 0;
}

void note_members(const Relation& relation, size_t k, std::vector<std::vector<size_t>>& involved) {
  for (const auto& term : relation) {
    std::vector<size_t>& relations = involved[index(term.first)];
    if (relations.empty() || relations.back() != k) relations.push_back(k);
  }
}

}  // namespace

bool exchange_to_first(const std::vector<int>& order, unsigned long prime,
                       std::vector<DependentRow>& dependents, std::vector<int>& basis) {
  std::vector<int> place(order.size()), basis_place(order.size());
  for (size_t k = 0; k < order.size(); ++k) place[index(order[k])] = static_cast<int>(k);
  for (size_t k = 0; k < basis.size(); ++k) basis_place[index(basis[k])] = static_cast<int>(k);
  const auto last_member = [&](const Relation& relation) {
    return std::max_element(relation.begin(), relation.end(),
                            [&](const auto& a, const auto& b) {
                              return place[index(a.first)] < place[index(b.first)];
                            })
        ->first;
  };
  if (std::all_of(dependents.begin(), dependents.end(), [&](const DependentRow& dependent) {
        return last_member(dependent.relation) == dependent.row;
      })) {
    return true;
  }
  std::vector<std::vector<size_t>> involved(order.size());  // relations, some of them once only
  for (size_t k = 0; k < dependents.size(); ++k) note_members(dependents[k].relation, k, involved);
  for (size_t k = 0; k < dependents.size(); ++k) {
    DependentRow& dependent = dependents[k];
    const int member = last_member(dependent.relation);
    if (member == dependent.row) continue;
    if (multiplier_of(dependent.relation, member)->modulo(prime) == 0) return false;
    basis[index(basis_place[index(member)])] = dependent.row;
    basis_place[index(dependent.row)] = basis_place[index(member)];
    dependent.row = member;
    for (const size_t other : std::exchange(involved[index(member)], {})) {
      Relation& relation = dependents[other].relation;
      if (other == k || multiplier_of(relation, member) == nullptr) continue;
      relation = eliminated(relation, dependent.relation, member);
      note_members(relation, other, involved);
    }
  }
  return true;
}

std::vector<int> dependent_on_first(const PrimeField& field, const std::vector<int>& rows_in_order,
                                    std::vector<ModularRelation> relations) {
  // By place in the order, the last member of a relation is the last entry.
  const IndexMap place(rows_in_order);
  for (ModularRelation& relation : relations) {
    for (auto& term : relation) term.first = place[term.first];
    std::sort(relation.begin(), relation.end());
  }
  std::vector<int> dependent;
  for (size_t k = 0; k < relations.size(); ++k) {
    const auto [last, value] = relations[k].back();
    dependent.push_back(rows_in_order[index(last)]);
    for (size_t other = 0; other < relations.size(); ++other) {
      const Residue there = other == k ? 0 : coefficient_of(relations[other], last);
      if (there == 0) continue;
      relations[other] = eliminated(field, relations[other], relations[k], there, value);
    }
  }
  std::sort(dependent.begin(), dependent.end());
  return dependent;
}

}  // namespace isochor::internal
