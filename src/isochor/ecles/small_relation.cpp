#include "isochor/ecles/small_relation.h"

#include <algorithm>

namespace isochor::internal {
namespace {

using Equation = std::vector<Integer>;  // coefficient of each row's multiplier

void remove_content(Equation& numbers) {
  const Integer one(1);
  Integer content;
  for (const Integer& number : numbers) {
    if (number.is_zero()) continue;
    content = gcd(content, number);
    if (content == one) return;
  }
  if (content.is_zero()) return;
  for (Integer& number : numbers) {
    if (!number.is_zero()) number = number.divided_exactly(content);
  }
}

// numbers = a numbers - b others.
void combine(Equation& numbers, const Integer& a, const Equation& others, const Integer& b) {
  for (size_t k = 0; k < numbers.size(); ++k) {
    if (!numbers[k].is_zero()) numbers[k] *= a;
    if (!others[k].is_zero()) numbers[k].add_product(others[k], b);
  }
}

class Equations {
 public:
  explicit Equations(size_t unknowns) : is_pivot_(unknowns) {}

  size_t rank() const { return pivots_.size(); }

  void add(Equation equation) {
    for (const auto& [pivot, reduced] : pivots_) {
      if (equation[pivot].is_zero()) continue;
      const Integer common = gcd(equation[pivot], reduced[pivot]);
      const Integer by = -equation[pivot].divided_exactly(common);
      combine(equation, reduced[pivot].divided_exactly(common), reduced, by);
    }
    remove_content(equation);
    const auto found = std::find_if(equation.begin(), equation.end(),
                                    [](const Integer& number) { return !number.is_zero(); });
    if (found == equation.end()) return;
    const auto pivot = static_cast<size_t>(found - equation.begin());
    is_pivot_[pivot] = true;
    pivots_.emplace_back(pivot, std::move(equation));
  }

  // The solution, one unknown being free.
  Equation solution() const {
    Equation y(is_pivot_.size());
    const auto free = std::find(is_pivot_.begin(), is_pivot_.end(), false);
    y[static_cast<size_t>(free - is_pivot_.begin())] = Integer(1);
    for (auto row = pivots_.rbegin(); row != pivots_.rend(); ++row) {
      const auto& [pivot, equation] = *row;
      Integer sum;
      for (size_t k = 0; k < y.size(); ++k) {
        if (!y[k].is_zero() && !equation[k].is_zero()) sum.add_product(equation[k], y[k]);
      }
      if (sum.is_zero()) continue;
      const Integer common = gcd(sum, equation[pivot]);
      const Integer factor = equation[pivot].divided_exactly(common);
      for (Integer& number : y) {
        if (!number.is_zero()) number *= factor;
      }
      y[pivot] = -sum.divided_exactly(common);
    }
    remove_content(y);
    return y;
  }

 private:
  std::vector<bool> is_pivot_;
  std::vector<std::pair<size_t, Equation>> pivots_;
};

struct Entry {
  int column = 0;
  size_t row = 0;
  const Integer* value = nullptr;
};
using Column = ArrayView<Entry>;

std::vector<Entry> entries_by_column(const LocalSystem& system, const std::vector<int>& rows) {
  std::vector<Entry> entries;
  for (size_t i = 0; i < rows.size(); ++i) {
    for (const LocalTerm& term : system.row(rows[i])) {
      entries.push_back({term.column, i, term.value});
    }
  }
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return a.column != b.column ? a.column < b.column : a.row < b.row;
  });
  return entries;
}

// The short ones first.
std::vector<Column> columns_of(const std::vector<Entry>& entries) {
  std::vector<Column> columns;
  for (const Entry *begin = entries.data(), *end = begin + entries.size(); begin != end;) {
    const Entry* next = begin;
    while (next != end && next->column == begin->column) ++next;
    columns.emplace_back(begin, next);
    begin = next;
  }
  std::sort(columns.begin(), columns.end(), [](const Column& a, const Column& b) {
    return a.size() != b.size() ? a.size() < b.size() : a.begin() < b.begin();
  });
  return columns;
}

bool satisfied(const Column& column, const Equation& y) {
  Integer sum;
  for (const Entry& entry : column) sum.add_product(*entry.value, y[entry.row]);
  return sum.is_zero();
}

}  // namespace

std::optional<Relation> small_relation(const LocalSystem& system, const std::vector<int>& rows) {
  const std::vector<Entry> entries = entries_by_column(system, rows);
  const std::vector<Column> columns = columns_of(entries);
  Equations equations(rows.size());
  auto column = columns.begin();
  for (; column != columns.end() && equations.rank() + 1 < rows.size(); ++column) {
    Equation equation(rows.size());
    for (const Entry& entry : *column) equation[entry.row] = *entry.value;
    equations.add(std::move(equation));
  }
  if (equations.rank() + 1 != rows.size()) return std::nullopt;
  Equation y = equations.solution();
  for (; column != columns.end(); ++column) {
    if (!satisfied(*column, y)) return std::nullopt;
  }
  Relation relation;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (y[i].is_zero()) return std::nullopt;
    relation.emplace_back(rows[i], std::move(y[i]));
  }
  return relation;
}

}  // namespace isochor::internal
