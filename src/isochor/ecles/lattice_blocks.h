// The integer solutions of R_ED x = -R_EA z, block by block.
//
// Symbols (Rodrigues 2017, ch. 5): E independent rows, D derived parameters, A anchors, z integer
// moves of the anchors. The blocks are found in the matrix itself. A column of one row only is
// *private* to it.
//   1. A row with two or more private columns without a common factor can follow whatever the
//      others do: it is *peeled*, a block on its private columns, solved last.
//   2. The rows that remain fall into connected components, each a lattice of solutions.
//   3. In a component of too many columns every row with private columns is peeled; when these have
//      the common factor g, the row's other columns are restricted to multiples that g divides
//      (`restricted`: solutions are lost, none is wrong).
//   4. Components that stay too large, or whose numbers leave machine words, are *loose*: no
//      lattice; their parameters have to be solved in rationals, with the peeled rows that meet
//      them.
//   5. Columns of no block are free: each is rounded by itself.
// The anchors' moves for which all blocks have integer solutions form a lattice too.
//
// Laws (tests/ecles/lattice_blocks_test.cpp):
//  (1) cover:  every row is in one block or loose, every derived parameter in one block, free or
//              loose
//  (2) bound:  nearest() ends within bound[k] of targets that solve the rows, for each k
//  (3) anchors: nearest() has a solution for every z in the anchors' lattice; where nothing is
//              restricted, for no other z
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "isochor/ecles/lattice.h"
#include "isochor/ecles/relevant.h"

namespace isochor::internal {

// Lattices of blocks met before, by their rows, columns and multipliers.
class LatticeCache {
 public:
  std::shared_ptr<const SolutionLattice> get(const IntegerMatrix& a, const std::vector<int>& rows,
                                             const std::vector<int>& columns,
                                             const std::vector<Integer>& multipliers);

 private:
  std::map<std::vector<long>, std::shared_ptr<const SolutionLattice>> lattices_;
};

// The moves of the anchors that blocks admit: a lattice of full rank in Z^A.
class AnchorLattice {
 public:
  explicit AnchorLattice(size_t anchors);
  // Keeps the z for which `hermite` (lower triangular) divides coefficients z.
  void restrict_to(const IntegerMatrix& coefficients, const IntegerVectors& hermite);
  const IntegerVectors& basis() const { return basis_; }
  // A near admissible move; z itself when it is one. False when numbers leave the machine words.
  [[nodiscard]] bool nearest(const std::vector<long>& z, std::vector<Wide>& result) const;

 private:
  IntegerVectors basis_;
  std::optional<NearestPlane> rounding_;  // none while every move is admissible
  bool fits_ = true;
};

struct LatticeBlock {
  struct Outside {
    int index = 0;  // position in A or in D
    long coefficient = 0;
  };
  std::vector<int> rows;                      // of the matrix
  std::vector<int> columns;                   // positions in D
  std::vector<std::vector<Outside>> anchors;  // by row
  std::vector<Outside> derived;               // peeled: the row's other columns
  std::vector<double> coefficients;           // peeled: of the private columns
  std::shared_ptr<const SolutionLattice> lattice;
  bool peeled = false;
};

struct LatticeLimits {
  int columns = 64;                                        // of a block
  double bound = std::numeric_limits<double>::infinity();  // of one block's rounding
};

class LatticeBlocks {
 public:
  // `rows` independent on D. Weights in the order of D, empty for all equal.
  LatticeBlocks(const ConstraintMatrix& matrix, const Selection& selection,
                const std::vector<int>& rows, const std::vector<double>& weights,
                const LatticeLimits& limits, LatticeCache& cache);

  const std::vector<LatticeBlock>& blocks() const { return blocks_; }
  const std::vector<int>& free() const { return free_; }              // positions in D
  const std::vector<int>& loose_rows() const { return loose_rows_; }  // of the matrix
  const std::vector<int>& loose() const { return loose_; }            // positions in D
  bool restricted() const { return restricted_; }
  const AnchorLattice& anchors() const { return anchors_; }
  // By position in D: how far rounding can end from the target; infinite where a loose block hangs
  // on rounded parameters.
  const std::vector<double>& bound() const { return bound_; }

  // Integer x near to the target, which solves R_ED x = -R_EA z in reals; loose positions are left
  // at zero. False when a number leaves 128 bits or there is no solution.
  [[nodiscard]] bool nearest(const std::vector<Wide>& z, const std::vector<double>& target,
                             std::vector<Wide>& x) const;
  struct Obstacle {
    std::vector<int> rows;
    LatticeObstacle proof;
    bool restricted = false;  // the proof holds on the restricted columns only
  };
  // Why z is not admissible; nothing when it is.
  std::optional<Obstacle> obstacle(const std::vector<Integer>& z) const;

 private:
  struct System;
  bool suits(const SolutionLattice& lattice) const;
  void build_component(const System& system, const std::vector<int>& rows, LatticeCache& cache);
  void build_peeled(const System& system, int row, LatticeCache& cache);
  void set_loose(const System& system, const std::vector<int>& rows);
  void set_bounds();
  double peeled_share(const LatticeBlock& block, size_t column) const;

  LatticeLimits limits_;
  std::vector<LatticeBlock> blocks_;
  std::vector<int> free_, loose_rows_, loose_;
  std::vector<Integer> multipliers_;
  std::vector<double> inverse_weights_, bound_;
  // Peeled rows with a common factor: the anchors' part must be a multiple of it.
  struct Congruence {
    int row = 0;
    std::vector<std::pair<int, Integer>> anchors;
    Integer modulus;
  };
  std::vector<Congruence> congruences_;
  std::vector<int> parameters_;  // D
  std::vector<char> is_loose_;
  bool hangs_ = false;  // a loose row meets rounded parameters
  AnchorLattice anchors_{0};
  bool restricted_ = false;
};

}  // namespace isochor::internal
