#include "isochor/ecles/lattice_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "isochor/base/error.h"
#include "isochor/ecles/index_map.h"

namespace isochor::internal {
namespace {

constexpr size_t kCacheSize = 8192;  // lattices; a cache that is full starts again

int root_of(std::vector<int>& parent, int i) {
  while (parent[static_cast<size_t>(i)] != i)
    i = parent[static_cast<size_t>(i)] =
        parent[static_cast<size_t>(parent[static_cast<size_t>(i)])];
  return i;
}

// Replaces the vectors by a basis of those combinations whose given entry is a multiple.
void keep_multiples(IntegerVectors& vectors, size_t entry, const Integer& modulus) {
  const int count = static_cast<int>(vectors.size());
  IntegerMatrix row(1, count + 1);
  bool all = true;
  for (int k = 0; k < count; ++k) {
    const Integer& value = vectors[static_cast<size_t>(k)][entry];
    row.set(0, k, value - value.divided_floor(modulus) * modulus);
    all = all && row.at(0, k).is_zero();
  }
  if (all) return;
  row.set(0, count, modulus);
  const SolutionLattice combinations(
      row, std::vector<Integer>(static_cast<size_t>(count) + 1, Integer(1)));
  IntegerVectors result;
  for (const auto& combination : combinations.kernel()) {
    result.emplace_back(vectors[0].size());
    for (size_t k = 0; k < vectors.size(); ++k)
      for (size_t j = 0; j < result.back().size(); ++j)
        if (!combination[k].is_zero()) result.back()[j].add_product(combination[k], vectors[k][j]);
  }
  vectors = std::move(result);
}

}  // namespace

// The rows by position in A and in D.
struct LatticeBlocks::System {
  struct Entry {
    int position = 0;
    Integer coefficient;
  };
  struct Row {
    int row = 0;
    std::vector<Entry> derived, anchors;
    std::vector<Entry> owned;  // of derived: the private ones
    Integer common;            // their greatest common divisor
    bool words = true;         // every coefficient fits a long
  };
  std::vector<Row> rows;
  std::vector<int> owners;  // by position in D: rows
  size_t anchors = 0;

  System(const ConstraintMatrix& matrix, const Selection& selection, const std::vector<int>& given)
      : owners(selection.derived.size()), anchors(selection.anchors.size()) {
    const IndexMap derived(selection.derived), anchor(selection.anchors);
    ISOCHOR_REQUIRE(!derived.has_repetition() && !anchor.has_repetition());
    for (const int i : given) {
      rows.emplace_back();
      Row& row = rows.back();
      row.row = i;
      for (const ConstraintTerm& term : matrix.row(i)) {
        const int d = derived[term.parameter], a = anchor[term.parameter];
        if (d >= 0) row.derived.push_back({d, term.coefficient});
        if (a >= 0) row.anchors.push_back({a, term.coefficient});
        row.words = row.words && ((d < 0 && a < 0) || term.coefficient.to_long());
        if (d >= 0) ++owners[static_cast<size_t>(d)];
      }
    }
    for (Row& row : rows)
      for (const Entry& entry : row.derived)
        if (owners[static_cast<size_t>(entry.position)] == 1) {
          row.owned.push_back(entry);
          row.common = gcd(row.common, entry.coefficient);
        }
  }

  // Components of the given rows (indices into rows), by shared derived columns.
  std::vector<std::vector<int>> components(const std::vector<int>& among) const {
    std::vector<int> parent(among.size()), first(owners.size(), -1);
    std::iota(parent.begin(), parent.end(), 0);
    for (size_t k = 0; k < among.size(); ++k)
      for (const Entry& entry : rows[static_cast<size_t>(among[k])].derived) {
        int& seen = first[static_cast<size_t>(entry.position)];
        if (seen < 0) seen = static_cast<int>(k);
        parent[static_cast<size_t>(root_of(parent, static_cast<int>(k)))] = root_of(parent, seen);
      }
    std::map<int, std::vector<int>> groups;
    for (size_t k = 0; k < among.size(); ++k)
      groups[root_of(parent, static_cast<int>(k))].push_back(among[k]);
    std::vector<std::vector<int>> result;
    for (auto& group : groups) result.push_back(std::move(group.second));
    return result;
  }

  std::vector<int> columns(const std::vector<int>& of) const {
    std::vector<int> result;
    for (const int r : of)
      for (const Entry& entry : rows[static_cast<size_t>(r)].derived)
        result.push_back(entry.position);
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }
};

std::shared_ptr<const SolutionLattice> LatticeCache::get(const IntegerMatrix& a,
                                                         const std::vector<int>& rows,
                                                         const std::vector<int>& columns,
                                                         const std::vector<Integer>& multipliers) {
  std::vector<long> key(rows.begin(), rows.end());
  key.push_back(-1);
  key.insert(key.end(), columns.begin(), columns.end());
  for (const Integer& multiplier : multipliers) {
    const auto word = multiplier.to_long();
    if (!word) return std::make_shared<SolutionLattice>(a, multipliers);
    key.push_back(*word);
  }
  auto& slot = lattices_[std::move(key)];
  if (!slot) slot = std::make_shared<SolutionLattice>(a, multipliers);
  auto result = slot;
  if (lattices_.size() > kCacheSize) lattices_.clear();
  return result;
}

AnchorLattice::AnchorLattice(size_t anchors) : basis_(anchors, std::vector<Integer>(anchors)) {
  for (size_t k = 0; k < anchors; ++k) basis_[k][k] = 1;
}

// Row after row of hermite w == coefficients z: every w_i is a linear function of z, known by its
// values on the basis, and must be an integer.
void AnchorLattice::restrict_to(const IntegerMatrix& coefficients, const IntegerVectors& hermite) {
  const size_t m = hermite.size(), n = basis_.size();
  std::vector<size_t> touched;
  IntegerVectors vectors;  // basis vector, its coefficients' products, its w
  for (size_t k = 0; k < n; ++k) {
    std::vector<Integer> vector = basis_[k];
    vector.resize(n + 2 * m);
    bool any = false;
    for (size_t i = 0; i < m; ++i) {
      for (size_t j = 0; j < n; ++j)
        vector[n + i].add_product(coefficients.at(static_cast<int>(i), static_cast<int>(j)),
                                  basis_[k][j]);
      any = any || !vector[n + i].is_zero();
    }
    if (!any) continue;
    touched.push_back(k);
    vectors.push_back(std::move(vector));
  }
  if (touched.empty()) return;
  for (size_t i = 0; i < m; ++i) {
    for (auto& vector : vectors) {
      vector[n + m + i] = vector[n + i];
      for (size_t k = 0; k < i; ++k)
        vector[n + m + i].add_product(-hermite[i][k], vector[n + m + k]);
    }
    const Integer& modulus = hermite[i][i];
    if (modulus == Integer(1)) continue;
    keep_multiples(vectors, n + m + i, modulus);
    for (auto& vector : vectors) vector[n + m + i] = vector[n + m + i].divided_exactly(modulus);
  }
  for (auto& vector : vectors) vector.resize(n);
  reduce_basis(vectors);
  for (size_t k = 0; k < touched.size(); ++k) basis_[touched[k]] = std::move(vectors[k]);
  for (const auto& vector : basis_)
    for (const Integer& entry : vector) fits_ = fits_ && entry.to_long();
  if (fits_) rounding_ = NearestPlane(basis_);
}

bool AnchorLattice::nearest(const std::vector<long>& z, std::vector<Wide>& result) const {
  if (!rounding_ && fits_) {
    result.assign(z.begin(), z.end());
    return true;
  }
  if (!fits_) return false;
  // In steps: what a double loses of z in one step is left for the next.
  result.assign(z.size(), 0);
  for (int pass = 0; pass < 4; ++pass) {
    std::vector<double> rest;
    for (size_t k = 0; k < z.size(); ++k) rest.push_back(static_cast<double>(z[k] - result[k]));
    std::vector<Wide> step(z.size(), 0);
    if (!rounding_->round(rest, step)) return false;
    for (size_t k = 0; k < z.size(); ++k) result[k] += step[k];
  }
  return true;
}

LatticeBlocks::LatticeBlocks(const ConstraintMatrix& matrix, const Selection& selection,
                             const std::vector<int>& rows, const std::vector<double>& weights,
                             const LatticeLimits& limits, LatticeCache& cache)
    : limits_(limits),
      multipliers_(selection.derived.size(), Integer(1)),
      parameters_(selection.derived),
      is_loose_(selection.derived.size(), 0),
      anchors_(selection.anchors.size()) {
  const System system(matrix, selection, rows);
  for (size_t k = 0; k < selection.derived.size(); ++k)
    inverse_weights_.push_back(weights.empty() ? 1.0 : 1.0 / weights[k]);
  std::vector<int> peeled, rest;
  const auto count = static_cast<int>(system.rows.size());
  for (int r = 0; r < count; ++r) {
    const auto& row = system.rows[static_cast<size_t>(r)];
    (row.owned.size() >= 2 && row.common == Integer(1) ? peeled : rest).push_back(r);
  }
  const auto too_large = [&](const std::vector<int>& component) {
    return system.columns(component).size() > static_cast<size_t>(limits_.columns);
  };
  std::vector<std::vector<int>> components, loose;
  for (auto& component : system.components(rest)) {
    if (!too_large(component)) {
      components.push_back(std::move(component));
      continue;
    }
    std::vector<int> core;
    for (const int r : component)
      (system.rows[static_cast<size_t>(r)].owned.empty() ? core : peeled).push_back(r);
    for (auto& part : system.components(core))
      (too_large(part) ? loose : components).push_back(std::move(part));
  }
  for (const auto& component : loose) set_loose(system, component);
  for (const int r : peeled) {
    const auto& row = system.rows[static_cast<size_t>(r)];
    if (row.common == Integer(1)) continue;
    restricted_ = true;
    for (const auto& entry : row.derived)
      if (system.owners[static_cast<size_t>(entry.position)] > 1) {
        Integer& multiplier = multipliers_[static_cast<size_t>(entry.position)];
        multiplier =
            lcm(multiplier, row.common.divided_exactly(gcd(row.common, entry.coefficient)));
      }
  }
  for (const auto& component : components) build_component(system, component, cache);
  // A row that hangs on loose columns is loose itself, and its private columns with it; these are
  // in no other row, so one pass is enough.
  for (const int r : peeled) build_peeled(system, r, cache);
  std::vector<char> covered = is_loose_;
  for (const LatticeBlock& block : blocks_)
    for (const int k : block.columns) covered[static_cast<size_t>(k)] = 1;
  for (size_t k = 0; k < covered.size(); ++k) {
    if (!covered[k]) free_.push_back(static_cast<int>(k));
    if (is_loose_[k]) loose_.push_back(static_cast<int>(k));
  }
  set_bounds();
}

bool LatticeBlocks::suits(const SolutionLattice& lattice) const {
  if (!lattice.fits()) return false;
  const std::vector<double> bound = lattice.bound();
  return std::all_of(bound.begin(), bound.end(), [&](double b) { return b <= limits_.bound; });
}

void LatticeBlocks::set_loose(const System& system, const std::vector<int>& rows) {
  for (const int r : rows) loose_rows_.push_back(system.rows[static_cast<size_t>(r)].row);
  for (const int k : system.columns(rows)) is_loose_[static_cast<size_t>(k)] = 1;
}

void LatticeBlocks::build_component(const System& system, const std::vector<int>& rows,
                                    LatticeCache& cache) {
  LatticeBlock block;
  block.columns = system.columns(rows);
  IntegerMatrix a(static_cast<int>(rows.size()), static_cast<int>(block.columns.size()));
  IntegerMatrix moves(static_cast<int>(rows.size()), static_cast<int>(system.anchors));
  bool words = true, moved = false;
  std::vector<int> parameters;  // positions mean other parameters in the next selection
  for (size_t i = 0; i < rows.size(); ++i) {
    const auto& row = system.rows[static_cast<size_t>(rows[i])];
    block.rows.push_back(row.row);
    words = words && row.words;
    for (const auto& entry : row.derived) {
      const auto place =
          std::lower_bound(block.columns.begin(), block.columns.end(), entry.position);
      a.set(static_cast<int>(i), static_cast<int>(place - block.columns.begin()),
            entry.coefficient);
    }
    block.anchors.emplace_back();
    for (const auto& entry : row.anchors) {
      moved = true;
      moves.set(static_cast<int>(i), entry.position, entry.coefficient);
      if (words) block.anchors.back().push_back({entry.position, *entry.coefficient.to_long()});
    }
  }
  std::vector<Integer> multipliers;
  for (const int k : block.columns) {
    multipliers.push_back(multipliers_[static_cast<size_t>(k)]);
    parameters.push_back(parameters_[static_cast<size_t>(k)]);
  }
  if (words) block.lattice = cache.get(a, block.rows, parameters, multipliers);
  if (!words || !suits(*block.lattice)) return set_loose(system, rows);
  if (moved && block.lattice->index() != Integer(1))
    anchors_.restrict_to(moves, block.lattice->hermite());
  blocks_.push_back(std::move(block));
}

void LatticeBlocks::build_peeled(const System& system, int index, LatticeCache& cache) {
  const auto& row = system.rows[static_cast<size_t>(index)];
  LatticeBlock block;
  block.peeled = true;
  block.rows = {row.row};
  block.anchors.emplace_back();
  IntegerMatrix a(1, static_cast<int>(row.owned.size()));
  std::vector<int> parameters;
  for (const auto& entry : row.owned) {
    a.set(0, static_cast<int>(block.columns.size()), entry.coefficient);
    block.columns.push_back(entry.position);
    block.coefficients.push_back(entry.coefficient.to_double());
    parameters.push_back(parameters_[static_cast<size_t>(entry.position)]);
  }
  bool loose = !row.words;
  for (const auto& entry : row.derived) {
    if (system.owners[static_cast<size_t>(entry.position)] == 1) continue;
    loose = loose || is_loose_[static_cast<size_t>(entry.position)];
    if (!loose) block.derived.push_back({entry.position, *entry.coefficient.to_long()});
  }
  if (!loose)
    block.lattice = cache.get(a, block.rows, parameters,
                              std::vector<Integer>(block.columns.size(), Integer(1)));
  if (loose || !suits(*block.lattice)) {
    loose_rows_.push_back(row.row);
    for (const auto& entry : row.owned) is_loose_[static_cast<size_t>(entry.position)] = 1;
    hangs_ = hangs_ || row.derived.size() > row.owned.size();
    return;
  }
  Congruence congruence{row.row, {}, row.common};
  IntegerMatrix moves(1, static_cast<int>(system.anchors));
  for (const auto& entry : row.anchors) {
    block.anchors.back().push_back({entry.position, *entry.coefficient.to_long()});
    congruence.anchors.emplace_back(entry.position, entry.coefficient);
    moves.set(0, entry.position, entry.coefficient);
  }
  if (!row.anchors.empty() && row.common != Integer(1)) {
    anchors_.restrict_to(moves, {{row.common}});
    congruences_.push_back(std::move(congruence));
  }
  blocks_.push_back(std::move(block));
}

// How far the private column moves for one unit of the row's rest, at least change; where all
// weights are too heavy for doubles, as if they were equal.
double LatticeBlocks::peeled_share(const LatticeBlock& block, size_t column) const {
  double square = 0.0, unweighted = 0.0;
  for (size_t j = 0; j < block.columns.size(); ++j) {
    const double term = block.coefficients[j] * block.coefficients[j];
    square += inverse_weights_[static_cast<size_t>(block.columns[j])] * term;
    unweighted += term;
  }
  if (!(square > 0.0)) return block.coefficients[column] / unweighted;
  return inverse_weights_[static_cast<size_t>(block.columns[column])] * block.coefficients[column] /
         square;
}

void LatticeBlocks::set_bounds() {
  bound_.assign(multipliers_.size(), 0.0);
  for (const int k : free_)
    bound_[static_cast<size_t>(k)] = multipliers_[static_cast<size_t>(k)].to_double() / 2;
  if (hangs_)
    for (const int k : loose_)
      bound_[static_cast<size_t>(k)] = std::numeric_limits<double>::infinity();
  for (const LatticeBlock& block : blocks_) {
    const std::vector<double> own = block.lattice->bound();
    double rest = 0.0;
    for (const auto& entry : block.derived)
      rest += std::fabs(static_cast<double>(entry.coefficient)) *
              bound_[static_cast<size_t>(entry.index)];
    for (size_t j = 0; j < own.size(); ++j)
      bound_[static_cast<size_t>(block.columns[j])] =
          own[j] + (block.peeled ? std::fabs(peeled_share(block, j)) * rest : 0.0);
  }
}

bool LatticeBlocks::nearest(const std::vector<Wide>& z, const std::vector<double>& target,
                            std::vector<Wide>& x) const {
  x.assign(target.size(), 0);
  for (const int k : free_) {
    const auto at = static_cast<size_t>(k);
    const auto multiplier = multipliers_[at].to_long();
    const double steps = std::nearbyint(target[at] / multipliers_[at].to_double());
    if (!multiplier || !(std::fabs(steps) < 0x1p62)) return false;
    if (!add_product(x[at], static_cast<Wide>(steps), *multiplier)) return false;
  }
  std::vector<Wide> s, part;
  std::vector<double> goal;
  for (const LatticeBlock& block : blocks_) {
    s.assign(block.rows.size(), 0);
    for (size_t i = 0; i < s.size(); ++i)
      for (const auto& entry : block.anchors[i])
        if (!add_product(s[i], -z[static_cast<size_t>(entry.index)], entry.coefficient))
          return false;
    goal.clear();
    for (const int k : block.columns) goal.push_back(target[static_cast<size_t>(k)]);
    if (block.peeled) {
      for (const auto& entry : block.derived)
        if (!add_product(s[0], -x[static_cast<size_t>(entry.index)], entry.coefficient))
          return false;
      double rest = static_cast<double>(s[0]);
      for (size_t j = 0; j < goal.size(); ++j) rest -= block.coefficients[j] * goal[j];
      for (size_t j = 0; j < goal.size(); ++j) goal[j] += peeled_share(block, j) * rest;
    }
    if (!block.lattice->nearest(s, goal, part)) return false;
    for (size_t j = 0; j < part.size(); ++j) x[static_cast<size_t>(block.columns[j])] = part[j];
  }
  return true;
}

std::optional<LatticeBlocks::Obstacle> LatticeBlocks::obstacle(
    const std::vector<Integer>& z) const {
  for (const LatticeBlock& block : blocks_) {
    if (block.peeled) continue;
    std::vector<Integer> s(block.rows.size());
    for (size_t i = 0; i < s.size(); ++i)
      for (const auto& entry : block.anchors[i])
        s[i].add_product(z[static_cast<size_t>(entry.index)], -entry.coefficient);
    auto proof = block.lattice->obstacle(s);
    if (!proof) continue;
    bool restricted = false;
    for (const int k : block.columns)
      restricted = restricted || multipliers_[static_cast<size_t>(k)] != Integer(1);
    return Obstacle{block.rows, std::move(*proof), restricted};
  }
  for (const Congruence& congruence : congruences_) {
    Integer sum;
    for (const auto& [k, coefficient] : congruence.anchors)
      sum.add_product(-coefficient, z[static_cast<size_t>(k)]);
    if (!sum.is_multiple_of(congruence.modulus))
      return Obstacle{
          {congruence.row},
          {{Rational(Integer(1), congruence.modulus)}, Rational(sum, congruence.modulus)},
          true};
  }
  return std::nullopt;
}

}  // namespace isochor::internal
