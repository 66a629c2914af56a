// The loops of contraction_kernel.h for one kind of vector, `Lanes`, which offers
//   using Vector;  load(const Pack&), store(Pack&, Vector), broadcast(double), zero(),
//   load_once(const Pack&), for numbers that are used twice and should stay in a register,
//   difference(a, b), add_product(a, b, c) = c + a b,  subtract_product(a, b, c) = c - a b.
// Included by one source file for every instruction set. Nothing here may be shared with code that
// is compiled for another one: no function of any library, and every template depends on Lanes,
// which is local to its file.
//
// The degree is a template parameter D, or 0 for a count known at run time. Registers: with three
// columns, `areas` keeps a group of up to three T's (nine sums) beside three D's; each D is loaded
// once per group, each of along_u's numbers once and used twice, so loads stay below products.
#pragma once

#include "isochor/volume/contraction_kernel.h"

namespace isochor::internal {

template <typename Lanes, Columns kColumns>
struct StageLoops {
  using Vector = typename Lanes::Vector;
  static constexpr int kIn = kColumns == Columns::kAll ? 3 : 2;
  static constexpr int kOut = kColumns == Columns::kAll ? 3 : 1;

  // The sum over s for one offset o; returns where the numbers of the next one begin.
  [[gnu::always_inline]] static const Pack* pair(const Pack* tau, const Pack* steps, int first,
                                                 int end, Pack* out) {
    Vector sums[kIn];
    for (int c = 0; c < kIn; ++c) sums[c] = Lanes::zero();
    for (int s = first; s < end; ++s) {
      const Vector factor = Lanes::load(*tau++);
      for (int c = 0; c < kIn; ++c) {
        sums[c] = Lanes::add_product(factor, Lanes::load(steps[s * kIn + c]), sums[c]);
      }
    }
    for (int c = 0; c < kIn; ++c) Lanes::store(out[c], sums[c]);
    return tau;
  }

  // All offsets, the loops unrolled by recursion.
  template <int D, int O>
  [[gnu::always_inline]] static void all_pairs(const Pack* tau, const Pack* steps, Pack* out) {
    tau = pair(tau, steps, first_step(D, O), end_step(D, O), out);
    if constexpr (O < 2 * D) all_pairs<D, O + 1>(tau, steps, out + kIn);
  }

  template <int D>
  static void pairs(const PairsArguments& p) {
    const int e = D > 0 ? D : p.degree;
    const Pack* tau = p.tau;
    Pack* out = p.pairs;
    for (int t = 0; t < p.length; ++t) {
      const Pack* steps = p.steps + t * kIn;
      if constexpr (D > 0) {
        all_pairs<D, 0>(tau, steps, out);
        tau += step_count(D);
        out += kIn * (2 * D + 1);
      } else {
        for (int o = 0; o <= 2 * e; ++o, out += kIn) {
          tau = pair(tau, steps, first_step(e, o), end_step(e, o), out);
        }
      }
    }
  }

  // T[a] for `Group` neighbouring a's, added to the rows that they reach.
  template <int Group>
  [[gnu::always_inline]] static void group(const RowsArguments& p, int d, int a, int t) {
    Vector areas[Group][kOut];
    for (int g = 0; g < Group; ++g) {
      for (int c = 0; c < kOut; ++c) areas[g][c] = Lanes::zero();
    }
    const Pack* pair = p.pairs + t * p.offsets * kIn;
    const Pack* along[Group];
    for (int g = 0; g < Group; ++g) along[g] = p.along_u[a + g] + t * kIn;
    for (int o = 0; o < p.offsets; ++o, pair += kIn) {
      Vector q[kIn];
      for (int c = 0; c < kIn; ++c) q[c] = Lanes::load(pair[c]);
      for (int g = 0; g < Group; ++g) {
        Vector f[kIn];
        for (int c = 0; c < kIn; ++c) f[c] = Lanes::load_once(along[g][c]);
        along[g] += kIn;
        for (int c = 0; c < kOut; ++c) {
          const int y = kOut == 3 ? (c + 1) % 3 : 0;
          const int z = kOut == 3 ? (c + 2) % 3 : 1;
          areas[g][c] = Lanes::add_product(f[y], q[z], areas[g][c]);
          areas[g][c] = Lanes::subtract_product(f[z], q[y], areas[g][c]);
        }
      }
    }
    // b_j with j = k - d + a meets B_i with i = k - d + b for a - d + 1 <= b <= a + d.
    const int first = a - d + 1 > 0 ? a - d + 1 : 0;
    const int last = a + Group - 1 < d ? a + Group - 1 + d : 2 * d;
    for (int b = first; b <= last; ++b) {
      Pack* row = p.rows[b] + t * kOut;
      Vector sums[kOut];
      for (int c = 0; c < kOut; ++c) sums[c] = Lanes::load(row[c]);
      for (int g = 0; g < Group; ++g) {
        const Vector factor = Lanes::broadcast(p.tau[(a + g) * (2 * d + 1) + b]);
        for (int c = 0; c < kOut; ++c) sums[c] = Lanes::add_product(factor, areas[g][c], sums[c]);
      }
      for (int c = 0; c < kOut; ++c) Lanes::store(row[c], sums[c]);
    }
  }

  template <int D, int A>
  [[gnu::always_inline]] static void all_groups(const RowsArguments& p, int t) {
    constexpr int kGroup = D % 3 == 0 ? 3 : 2;
    group<kGroup>(p, D, A, t);
    if constexpr (A + kGroup < 2 * D) all_groups<D, A + kGroup>(p, t);
  }

  template <int D>
  static void rows(const RowsArguments& p) {
    for (int t = 0; t < p.length; ++t) {
      if constexpr (D > 0) {
        all_groups<D, 0>(p, t);
      } else {
        for (int a = 0; a < 2 * p.degree; a += 2) group<2>(p, p.degree, a, t);
      }
    }
  }
};

template <typename Lanes>
void subtract(const Pack* a, const Pack* b, int count, Pack* out) {
  for (int k = 0; k < count; ++k) {
    Lanes::store(out[k], Lanes::difference(Lanes::load(a[k]), Lanes::load(b[k])));
  }
}

template <typename Lanes, Columns kColumns>
Stages stages_of(int u_degree, int v_degree) {
  using Loops = StageLoops<Lanes, kColumns>;
  Stages stages;
  stages.subtract = &subtract<Lanes>;
  switch (v_degree) {
    case 1:
      stages.pairs = &Loops::template pairs<1>;
      break;
    case 2:
      stages.pairs = &Loops::template pairs<2>;
      break;
    case 3:
      stages.pairs = &Loops::template pairs<3>;
      break;
    case 4:
      stages.pairs = &Loops::template pairs<4>;
      break;
    case 5:
      stages.pairs = &Loops::template pairs<5>;
      break;
    case 6:
      stages.pairs = &Loops::template pairs<6>;
      break;
    default:
      stages.pairs = &Loops::template pairs<0>;
      break;
  }
  switch (u_degree) {
    case 1:
      stages.rows = &Loops::template rows<1>;
      break;
    case 2:
      stages.rows = &Loops::template rows<2>;
      break;
    case 3:
      stages.rows = &Loops::template rows<3>;
      break;
    case 4:
      stages.rows = &Loops::template rows<4>;
      break;
    case 5:
      stages.rows = &Loops::template rows<5>;
      break;
    case 6:
      stages.rows = &Loops::template rows<6>;
      break;
    default:
      stages.rows = &Loops::template rows<0>;
      break;
  }
  return stages;
}

template <typename Lanes>
Stages stages_of(Columns columns, int u_degree, int v_degree) {
  return columns == Columns::kAll ? stages_of<Lanes, Columns::kAll>(u_degree, v_degree)
                                  : stages_of<Lanes, Columns::kOne>(u_degree, v_degree);
}

}  // namespace isochor::internal
