#include "isochor/ecles/problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "ecles/rational_elimination.h"
#include "isochor/base/error.h"
#include "isochor/ecles/problem_text.h"

namespace isochor {
namespace {

using test::Table;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Outcome = Solution::Outcome;

RationalPoint point(std::initializer_list<Rational> numbers) { return RationalPoint(numbers); }

// Example 2.2 of the thesis: four pumps, p1 + p2 = p3 and p4 = p3 + 5.
Problem pumps() {
  Problem problem;
  problem.parameters = {{"p1", {1}}, {"p2", {2}}, {"p3", {3}}, {"p4", {8}}};
  problem.constraints = {{"join", {{0, 1}, {1, 1}, {2, -1}}, {0}},
                         {"offset", {{3, 1}, {2, -1}}, {5}}};
  problem.anchors = {{0, {4}}};
  problem.derived = {{2, {3}, 1}, {3, {8}, 1}};
  return problem;
}

// Figure 2.1: a parallelogram in the plane, one corner is dragged.
Problem parallelogram() {
  Problem problem;
  problem.dimension = 2;
  problem.parameters = {
      {"p0", {0, 0}}, {"p1", {4, 0}}, {"p2", {5, 3}}, {"p3", {1, 3}}, {"p4", {7, 7}}};
  problem.constraints = {{"sides", {{0, 1}, {1, -1}, {2, 1}, {3, -1}}, {0, 0}}};
  problem.anchors = {{0, {-3, 2}}};
  problem.derived = {{1, {4, 0}, 1}, {2, {5, 3}, 1}, {3, {1, 3}, 1}};
  return problem;
}

TEST(Problem, PumpsOfTheThesis) {
  const Problem problem = pumps();
  const Solution solution = solve(problem);
  EXPECT_EQ(solution.outcome, Outcome::kSolved);
  EXPECT_THAT(solution.values, ElementsAre(point({4}), point({2}), point({6}), point({11})));
  EXPECT_EQ(solution.rank, 2);
  EXPECT_EQ(solution.freedom_left, 0);
  EXPECT_THAT(solution.relevant, ElementsAre(0, 1));
  EXPECT_TRUE(solution.strongly_solvable);
  EXPECT_TRUE(solution.proofs_verified);
  EXPECT_THAT(solution.violated_before, IsEmpty());
  EXPECT_THAT(headline(problem, solution), HasSubstr("solved: 1 anchor and 2 derived parameters"));
}

// By hand: p0 moves by (-3, 2), the three others share what is missing, +-1/3 of it each.
TEST(Problem, ParallelogramOfTheThesis) {
  const Solution solution = solve(parallelogram());
  const Rational third(1, 3);
  EXPECT_THAT(solution.values,
              ElementsAre(point({-3, 2}), point({Rational(3), Rational(2) * third}),
                          point({Rational(6), Rational(7) * third}),
                          point({Rational(0), Rational(11) * third}), point({7, 7})));
  EXPECT_EQ(solution.freedom_left, 2);
}

TEST(Problem, WeightsDecideWhoGivesWay) {
  Problem problem = parallelogram();
  problem.derived[0].weight = Rational(1'000'000);
  problem.derived[1].weight = Rational(1'000'000);
  const Solution solution = solve(problem);
  // Shares are 1 / weight: 1 : 1 : 1000000 of the 1000002 parts of (-3, 2).
  EXPECT_EQ(solution.values[3], point({Rational(1) - Rational(3'000'000, 1'000'002),
                                       Rational(3) + Rational(2'000'000, 1'000'002)}));
}

TEST(Problem, TheAnchorThatNothingCanFollow) {
  Problem problem = pumps();
  problem.derived = {{3, {8}, 1}};
  const Solution weak = solve(problem);
  EXPECT_EQ(weak.outcome, Outcome::kNotWeaklySolvable);
  EXPECT_THAT(weak.values, IsEmpty());
  ASSERT_EQ(weak.conflicts.size(), 1u);
  EXPECT_THAT(weak.conflicts[0].multipliers, ElementsAre(std::pair(0, Rational(1))));
  EXPECT_THAT(weak.conflicts[0].anchors, ElementsAre(std::pair(0, Rational(1))));
  EXPECT_THAT(weak.conflicts[0].residual, ElementsAre(Rational(-3)));
  EXPECT_EQ(sentence(problem, weak.conflicts[0]),
            "join does not allow the new p1: 1 x join reads 1 p1 = 1, but it is 4");

  problem.anchors[0].value = {1};  // where it is: solvable for this value alone
  const Solution still = solve(problem);
  EXPECT_EQ(still.outcome, Outcome::kSolved);
  EXPECT_FALSE(still.strongly_solvable);
  ASSERT_EQ(still.obstructions.size(), 1u);
  EXPECT_EQ(sentence(problem, still.obstructions[0]),
            "join binds p1: 1 x join reads 1 p1 = 1 whatever the derived parameters are");

  problem.require = Problem::Require::kStrong;
  const Solution strong = solve(problem);
  EXPECT_EQ(strong.outcome, Outcome::kNotStronglySolvable);
  EXPECT_EQ(strong.conflicts.size(), 1u);
  EXPECT_THAT(strong.redundant, IsEmpty());
}

TEST(Problem, ContradictionIsMinimalWithMultipliers) {
  Problem problem;
  problem.parameters = {{"x", {0}}, {"y", {0}}, {"z", {0}}};
  // twice says 2x - 2y = 1, once says x - y = 2: 2 once - twice reads 0 = 3. other is innocent.
  problem.constraints = {{"twice", {{0, 2}, {1, -2}}, {1}},
                         {"other", {{0, 1}, {2, 1}}, {0}},
                         {"once", {{0, 1}, {1, -1}}, {2}}};
  problem.derived = {{0, {0}, 1}, {1, {0}, 1}, {2, {0}, 1}};
  const Solution solution = solve(problem);
  EXPECT_EQ(solution.outcome, Outcome::kNotWeaklySolvable);
  ASSERT_EQ(solution.conflicts.size(), 1u);
  EXPECT_THAT(solution.conflicts[0].multipliers,
              ElementsAre(std::pair(2, Rational(2)), std::pair(0, Rational(-1))));
  EXPECT_EQ(sentence(problem, solution.conflicts[0]),
            "once and twice contradict each other: 2 x once - 1 x twice reads 0 = 3");
  EXPECT_TRUE(solution.strongly_solvable);  // no anchors, nothing to bind

  problem.constraints[0].equals = {4};
  const Solution repaired = solve(problem);
  EXPECT_EQ(repaired.outcome, Outcome::kSolved);
  ASSERT_EQ(repaired.redundant.size(), 1u);
  EXPECT_EQ(repaired.redundant[0].constraint, 0);  // the later name is the extra one
  EXPECT_THAT(sentence(problem, repaired.redundant[0].because),
              HasSubstr("once and twice say the same more than once"));
  EXPECT_EQ(repaired.freedom_left, 1);
}

TEST(Problem, BrokenStartsAreReportedAndRepairedWhereTheyMatter) {
  Problem problem = pumps();
  problem.parameters[3].value = {9};  // offset is off by one at the start
  problem.derived = {{2, {3}, 1}, {3, {9}, 1}};
  Solution solution = solve(problem);
  EXPECT_EQ(solution.outcome, Outcome::kSolved);
  ASSERT_EQ(solution.violated_before.size(), 1u);
  EXPECT_EQ(solution.violated_before[0].constraint, 1);
  EXPECT_TRUE(solution.violated_before[0].relevant);
  EXPECT_THAT(solution.violated_before[0].residual, ElementsAre(Rational(-1)));
  EXPECT_EQ(solution.values[3], point({11}));

  problem = pumps();  // an edit of p1 and p2 alone does not see the broken offset
  problem.parameters[3].value = {9};
  problem.derived = {{1, {2}, 1}};
  solution = solve(problem);
  EXPECT_EQ(solution.outcome, Outcome::kSolved);
  EXPECT_THAT(solution.relevant, ElementsAre(0));
  ASSERT_EQ(solution.violated_before.size(), 1u);
  EXPECT_FALSE(solution.violated_before[0].relevant);
  EXPECT_EQ(solution.values[3], point({9}));
}

TEST(Problem, OnlyHintsOrOnlyAnchors) {
  Problem problem = pumps();
  problem.anchors.clear();
  problem.derived = {{0, {2}, 1}, {1, {2}, 1}, {2, {3}, 1}};
  // p3 is tied to the fixed p4; p1 and p2 share the one too many.
  EXPECT_THAT(solve(problem).values, ElementsAre(point({Rational(3, 2)}), point({Rational(3, 2)}),
                                                 point({3}), point({8})));
  problem = pumps();
  problem.derived.clear();
  EXPECT_EQ(solve(problem).outcome, Outcome::kNotWeaklySolvable);
  problem.anchors = {{0, {0}}, {1, {3}}};
  EXPECT_EQ(solve(problem).outcome, Outcome::kSolved);
}

// A hint of a parameter that no constraint mentions, and a coefficient of zero.
TEST(Problem, FreeParametersTakeTheirHints) {
  Problem problem = parallelogram();
  problem.constraints[0].terms.emplace_back(4, 0);
  problem.derived.push_back({4, {Rational(1, 7), -2}, 5});
  const Solution solution = solve(problem);
  EXPECT_EQ(solution.values[4], point({Rational(1, 7), -2}));
  EXPECT_EQ(solution.freedom_left, 3);
}

// Random problems: rational coefficients, dependent rows, right sides that fit or do not.
class RandomProblems {
 public:
  explicit RandomProblems(unsigned seed) : engine_(seed) {}

  Problem next() {
    Problem problem;
    problem.dimension = draw(1, 3);
    const int parameters = draw(1, 8), constraints = draw(1, 8);
    for (int j = 0; j < parameters; ++j) {
      problem.parameters.push_back({"p" + std::to_string(j), random_point(problem.dimension)});
    }
    std::vector<std::vector<Rational>> rows;
    for (int i = 0; i < constraints; ++i) {
      std::vector<Rational> row(static_cast<size_t>(parameters));
      do {
        if (i >= 2 && draw(0, 2) == 0) {  // a combination of two earlier rows
          const Rational a = draw(-2, 2), b(draw(-3, 3), 2);
          for (size_t j = 0; j < row.size(); ++j) row[j] = a * rows[0][j] + b * rows[1][j];
        } else {
          for (Rational& entry : row) {
            entry = draw(0, 1) == 0 ? Rational(0) : Rational(draw(-4, 4), draw(1, 3));
          }
        }
      } while (std::all_of(row.begin(), row.end(), [](const auto& x) { return x.is_zero(); }));
      rows.push_back(row);
      put_constraint(problem, row);
    }
    for (int j = 0; j < parameters; ++j) {
      const int role = draw(0, 5);
      if (role == 0) problem.anchors.push_back({j, random_point(problem.dimension)});
      if (role >= 2) {
        problem.derived.push_back(
            {j, random_point(problem.dimension), Rational(draw(1, 9), draw(1, 4))});
      }
    }
    if (problem.anchors.empty() && problem.derived.empty()) {
      problem.anchors.push_back({0, problem.parameters[0].value});
    }
    return problem;
  }

  std::mt19937& engine() { return engine_; }

 private:
  int draw(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }
  RationalPoint random_point(int dimension) {
    RationalPoint result;
    for (int c = 0; c < dimension; ++c) result.push_back(Rational(draw(-9, 9), draw(1, 3)));
    return result;
  }
  // Fulfilled at the start, unless drawn otherwise.
  void put_constraint(Problem& problem, const std::vector<Rational>& row) {
    Problem::Constraint constraint{"c" + std::to_string(problem.constraints.size()), {}, {}};
    constraint.equals.resize(static_cast<size_t>(problem.dimension));
    for (size_t j = 0; j < row.size(); ++j) {
      if (row[j].is_zero()) continue;
      constraint.terms.emplace_back(static_cast<int>(j), row[j]);
      for (size_t c = 0; c < constraint.equals.size(); ++c) {
        constraint.equals[c] += row[j] * problem.parameters[j].value[c];
      }
    }
    if (draw(0, 3) == 0) constraint.equals[0] += 1;
    problem.constraints.push_back(constraint);
  }

  std::mt19937 engine_;
};

// The same questions asked by the book: dense tables of one component.
struct Oracle {
  Table on_derived, on_anchors, right;  // rows of all constraints; right: one column a dimension

  explicit Oracle(const Problem& problem, const std::vector<int>& rows) {
    std::map<int, size_t> anchor, derived;
    for (const auto& a : problem.anchors) anchor.emplace(a.parameter, anchor.size());
    for (const auto& d : problem.derived) derived.emplace(d.parameter, derived.size());
    for (int i : rows) {
      const auto& constraint = problem.constraints[static_cast<size_t>(i)];
      on_derived.emplace_back(derived.size());
      on_anchors.emplace_back(anchor.size());
      right.push_back(constraint.equals);
      for (const auto& [j, coefficient] : constraint.terms) {
        if (derived.count(j) != 0) {
          on_derived.back()[derived[j]] += coefficient;
          continue;
        }
        const bool moved = anchor.count(j) != 0;
        if (moved) on_anchors.back()[anchor[j]] += coefficient;
        const RationalPoint& value = moved ? problem.anchors[anchor[j]].value
                                           : problem.parameters[static_cast<size_t>(j)].value;
        for (size_t c = 0; c < value.size(); ++c) right.back()[c] -= coefficient * value[c];
      }
    }
  }

  bool weakly() const { return test::in_column_space(on_derived, right); }
  bool strongly() const { return test::in_column_space(on_derived, on_anchors); }

  // The conditions of Lagrange: [W A'; A 0] [x; y] = [W h; b], one column a dimension.
  Table nearest(const Problem& problem) const {
    const size_t n = problem.derived.size(), m = on_derived.size();
    Table table(n + m, std::vector<Rational>(n + m));
    Table sides;
    for (size_t k = 0; k < n; ++k) {
      table[k][k] = problem.derived[k].weight;
      for (size_t i = 0; i < m; ++i) table[k][n + i] = table[n + i][k] = on_derived[i][k];
      sides.push_back(problem.derived[k].hint);
      for (Rational& number : sides.back()) number *= problem.derived[k].weight;
    }
    sides.insert(sides.end(), right.begin(), right.end());
    const test::Echelon echelon = test::eliminated(test::beside(table, sides), n + m);
    Table result(n);
    for (size_t p = 0; p < echelon.pivots.size(); ++p) {
      if (echelon.pivots[p] < n) {
        result[echelon.pivots[p]].assign(echelon.rows[p].begin() + static_cast<long>(n + m),
                                         echelon.rows[p].end());
      }
    }
    return result;
  }
};

// The combination really cancels D, leaves these anchors and this residual; parts of it do not.
void expect_proof(const Problem& problem, const Combination& combination) {
  std::vector<int> rows;
  for (const auto& term : combination.multipliers) rows.push_back(term.first);
  const Oracle oracle(problem, rows);
  RationalPoint residual(static_cast<size_t>(problem.dimension));
  std::vector<Rational> derived(problem.derived.size()), anchors(problem.anchors.size());
  for (size_t k = 0; k < rows.size(); ++k) {
    const Rational& multiplier = combination.multipliers[k].second;
    for (size_t j = 0; j < derived.size(); ++j) derived[j] += multiplier * oracle.on_derived[k][j];
    for (size_t j = 0; j < anchors.size(); ++j) anchors[j] += multiplier * oracle.on_anchors[k][j];
    for (size_t c = 0; c < residual.size(); ++c) residual[c] += multiplier * oracle.right[k][c];
  }
  EXPECT_EQ(derived, std::vector<Rational>(derived.size()));
  EXPECT_EQ(residual, combination.residual);
  std::map<int, Rational> left;
  for (size_t k = 0; k < anchors.size(); ++k) {
    if (!anchors[k].is_zero()) left[problem.anchors[k].parameter] = anchors[k];
  }
  const std::map<int, Rational> told(combination.anchors.begin(), combination.anchors.end());
  EXPECT_EQ(told, left);
  for (size_t k = 0; k < rows.size(); ++k) {
    std::vector<int> part = rows;
    part.erase(part.begin() + static_cast<long>(k));
    EXPECT_TRUE(Oracle(problem, part).weakly()) << "not minimal";
  }
}

TEST(Problem, VerdictsAndValuesAreThoseOfTheBook) {
  RandomProblems problems(20170401);
  std::map<Outcome, int> seen;
  int bound = 0, redundant = 0;
  for (int trial = 0; trial < 600; ++trial) {
    Problem problem = problems.next();
    if (trial % 3 == 0) problem.require = Problem::Require::kStrong;
    const Solution solution = solve(problem);
    SCOPED_TRACE(trial);
    const Oracle oracle(problem, solution.relevant);
    EXPECT_EQ(solution.rank, static_cast<int>(test::rank(oracle.on_derived)));
    EXPECT_EQ(solution.strongly_solvable, oracle.strongly());
    EXPECT_EQ(solution.strongly_solvable, solution.obstructions.empty());
    const bool strong = problem.require == Problem::Require::kStrong;
    const Outcome expected = strong && !oracle.strongly() ? Outcome::kNotStronglySolvable
                             : oracle.weakly()            ? Outcome::kSolved
                                                          : Outcome::kNotWeaklySolvable;
    ASSERT_EQ(solution.outcome, expected);
    EXPECT_EQ(solution.conflicts.empty(), expected == Outcome::kSolved);
    for (const Combination& each : solution.conflicts) expect_proof(problem, each);
    for (const Combination& each : solution.obstructions) {
      EXPECT_THAT(each.anchors, Not(IsEmpty()));
      expect_proof(problem, each);
    }
    for (const Redundancy& each : solution.redundant) expect_proof(problem, each.because);
    bound += solution.strongly_solvable ? 0 : 1;
    redundant += solution.redundant.empty() ? 0 : 1;
    ++seen[solution.outcome];
    if (solution.outcome != Outcome::kSolved) continue;
    const Table nearest = oracle.nearest(problem);
    for (size_t k = 0; k < problem.derived.size(); ++k) {
      EXPECT_EQ(solution.values[static_cast<size_t>(problem.derived[k].parameter)], nearest[k]);
    }
  }
  EXPECT_GT(seen[Outcome::kSolved], 60);
  EXPECT_GT(seen[Outcome::kNotWeaklySolvable], 60);
  EXPECT_GT(seen[Outcome::kNotStronglySolvable], 20);
  EXPECT_GT(bound, 60);
  EXPECT_GT(redundant, 60);
}

// Everything a solution says, by names.
std::string transcript(const Problem& problem, const Solution& solution) {
  std::string text = std::string(name_of(solution.outcome)) + " " + std::to_string(solution.rank);
  std::map<std::string, RationalPoint> values;
  for (size_t j = 0; j < solution.values.size(); ++j) {
    values[problem.parameters[j].name] = solution.values[j];
  }
  for (const auto& [name, value] : values) text += "\n" + name + " " + text_of(value);
  const auto add = [&](const char* kind, const Combination& combination) {
    text += "\n" + std::string(kind) + text_of(combination.residual);
    for (const auto& [i, multiplier] : combination.multipliers) {
      text += " " + problem.constraints[static_cast<size_t>(i)].name + multiplier.to_string();
    }
  };
  for (const Combination& each : solution.conflicts) add("conflict", each);
  for (const Combination& each : solution.obstructions) add("obstruction", each);
  for (const Redundancy& each : solution.redundant) {
    text += "\n" + problem.constraints[static_cast<size_t>(each.constraint)].name;
    add("because", each.because);
  }
  return text;
}

TEST(Problem, FourMethodsSayTheSame) {
  RandomProblems problems(2017);
  int solved = 0;
  for (int trial = 0; trial < 150; ++trial) {
    Problem problem = problems.next();
    const Solution fast = solve(problem);
    solved += fast.outcome == Outcome::kSolved ? 1 : 0;
    for (const auto method :
         {Problem::Method::kGcd, Problem::Method::kTurner, Problem::Method::kPlain}) {
      problem.method = method;
      EXPECT_EQ(transcript(problem, solve(problem)), transcript(problem, fast))
          << trial << " " << name_of(method);
    }
  }
  EXPECT_GT(solved, 50);
}

// The same problem with its lists in another order.
Problem shuffled(const Problem& problem, std::mt19937& engine) {
  std::vector<int> order(problem.parameters.size());
  for (size_t j = 0; j < order.size(); ++j) order[j] = static_cast<int>(j);
  std::shuffle(order.begin(), order.end(), engine);
  Problem result = problem;
  for (size_t j = 0; j < order.size(); ++j) {
    result.parameters[static_cast<size_t>(order[j])] = problem.parameters[j];
  }
  const auto moved = [&](int& parameter) { parameter = order[static_cast<size_t>(parameter)]; };
  for (auto& constraint : result.constraints) {
    for (auto& term : constraint.terms) moved(term.first);
    std::shuffle(constraint.terms.begin(), constraint.terms.end(), engine);
  }
  for (auto& anchor : result.anchors) moved(anchor.parameter);
  for (auto& each : result.derived) moved(each.parameter);
  std::shuffle(result.constraints.begin(), result.constraints.end(), engine);
  std::shuffle(result.anchors.begin(), result.anchors.end(), engine);
  std::shuffle(result.derived.begin(), result.derived.end(), engine);
  return result;
}

TEST(Problem, OrderOfInputDoesNotMatter) {
  RandomProblems problems(1966);
  for (int trial = 0; trial < 200; ++trial) {
    Problem problem = problems.next();
    if (trial % 3 == 0) problem.require = Problem::Require::kStrong;
    const Problem other = shuffled(problem, problems.engine());
    EXPECT_EQ(transcript(problem, solve(problem)), transcript(other, solve(other))) << trial;
  }
}

// Change one thing and read the error.
template <typename Change>
std::string error_of(Problem problem, Change change) {
  change(problem);
  try {
    solve(problem);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Problem, MistakesNameThePlaceAndTheValue) {
  const Problem good = pumps();
  EXPECT_EQ(error_of(good, [](Problem& p) { p.parameters.clear(), p.constraints.clear(); }),
            "parameters: the list is empty: there is nothing to edit");
  EXPECT_EQ(error_of(good, [](Problem& p) { p.constraints.clear(); }),
            "constraints: the list is empty: there is nothing to keep");
  EXPECT_THAT(error_of(good, [](Problem& p) { p.anchors.clear(), p.derived.clear(); }),
              HasSubstr("neither anchors nor derived"));
  EXPECT_EQ(error_of(good, [](Problem& p) { p.parameters[2].name = "p1"; }),
            "parameters[2].name: the name \"p1\" occurs twice");
  EXPECT_EQ(error_of(good, [](Problem& p) { p.parameters[2].name = ""; }),
            "parameters[2].name: the name is empty");
  EXPECT_EQ(error_of(good, [](Problem& p) { p.constraints[1].name = "join"; }),
            "constraints[1].name: the name \"join\" occurs twice");
  EXPECT_EQ(error_of(good, [](Problem& p) { p.constraints[1].terms.clear(); }),
            "constraints[1].terms: the constraint \"offset\" has no terms");
  EXPECT_THAT(error_of(good,
                       [](Problem& p) {
                         p.constraints[1].terms = {{0, 0}};
                       }),
              HasSubstr("all coefficients of the constraint \"offset\" are zero"));
  EXPECT_THAT(error_of(good,
                       [](Problem& p) {
                         p.parameters[1].value = {1, 2};
                       }),
              HasSubstr("parameters[1].value: expected 1 numbers (the dimension), found 2"));
  EXPECT_THAT(error_of(good, [](Problem& p) { p.constraints[0].equals = {}; }),
              HasSubstr("constraints[0].equals: expected 1"));
  EXPECT_THAT(error_of(good,
                       [](Problem& p) {
                         p.anchors[0].value = {1, 2};
                       }),
              HasSubstr("anchors.p1: expected 1"));
  EXPECT_THAT(error_of(good,
                       [](Problem& p) {
                         p.derived[0].hint = {1, 2};
                       }),
              HasSubstr("derived.p3.hint: expected 1"));
  EXPECT_EQ(error_of(good, [](Problem& p) { p.derived[0].weight = 0; }),
            "derived.p3.weight: a weight must be positive, found 0");
  EXPECT_THAT(error_of(good, [](Problem& p) { p.derived[1].weight = Rational(-1, 2); }),
              HasSubstr("derived.p4.weight: a weight must be positive, found -1/2"));
  EXPECT_THAT(error_of(good, [](Problem& p) { p.derived[1].parameter = 0; }),
              HasSubstr("derived.p1: the parameter is already an anchor"));
  EXPECT_THAT(error_of(good,
                       [](Problem& p) {
                         p.anchors.push_back({0, {2}});
                       }),
              HasSubstr("anchors.p1: the parameter is already"));
  Problem broken = good;
  broken.anchors[0].parameter = 4;
  EXPECT_THROW(solve(broken), PreconditionError);
  broken = good;
  broken.constraints[0].terms[0].first = -1;
  EXPECT_THROW(solve(broken), PreconditionError);
  broken = good;
  broken.dimension = 0;
  EXPECT_THROW(solve(broken), PreconditionError);
}

// Differences of neighbours, the last value given: c_k says factor p_k - factor p_(k+1) = 0.
Problem chain(int constraints, const Rational& factor) {
  Problem problem;
  for (int j = 0; j <= constraints; ++j) {
    problem.parameters.push_back({"p" + std::to_string(j), {0}});
    if (j > 0) problem.derived.push_back({j, {j % 2}, 1});
  }
  for (int i = 0; i + 1 < constraints; ++i) {
    problem.constraints.push_back(
        {"c" + std::to_string(i), {{i, factor}, {i + 1, -factor}, {i + 2, 1}}, {0}});
  }
  problem.anchors = {{0, {1}}};
  return problem;
}

TEST(Problem, LimitsAreRefusedWithNumbersAfterTheVerdict) {
  Problem plain = chain(18, 1);
  plain.method = Problem::Method::kPlain;
  Solution solution = solve(plain);
  EXPECT_EQ(solution.outcome, Outcome::kRefused);
  EXPECT_THAT(solution.values, IsEmpty());
  EXPECT_EQ(solution.rank, 17);
  EXPECT_TRUE(solution.proofs_verified && solution.strongly_solvable);
  EXPECT_EQ(headline(plain, solution),
            "refused: the method \"plain\" doubles the length of its numbers with each of 17 "
            "independent constraints, the limit is 16; \"fast\" gives the same values");
  EXPECT_EQ(solve(chain(18, 1)).outcome, Outcome::kSolved);
  plain = chain(17, 1);
  plain.method = Problem::Method::kPlain;
  EXPECT_EQ(solve(plain).outcome, Outcome::kSolved);

  Problem wide = chain(320, 1);
  wide.method = Problem::Method::kTurner;
  EXPECT_THAT(solve(wide).reason, HasSubstr("it would fill 102080 coefficients"));

  solution = solve(chain(40, Rational::parse("1e2000")));
  EXPECT_THAT(solution.reason, HasSubstr("binary digits; the limit is 65536"));
  solution = solve(chain(16'200, 2));  // four digits a row: 64 795 each, 131 MB together
  EXPECT_EQ(solution.outcome, Outcome::kRefused);
  EXPECT_THAT(solution.reason, HasSubstr("derived parameters that hang together may need"));
  EXPECT_THAT(solution.reason, HasSubstr("MB; the limit is 128 MB"));
  EXPECT_EQ(solve(chain(40, 1000)).outcome, Outcome::kSolved);
}

TEST(Problem, LongSumsAreCutInSentences) {
  Problem problem;
  Combination all;
  for (int i = 0; i < 20; ++i) {
    const std::string number = std::to_string(i);
    problem.parameters.push_back({"p" + number, {0}});
    problem.constraints.push_back({"c" + number, {{i, 1}}, {0}});
    all.multipliers.emplace_back(i, i % 2 == 0 ? 1 : -1);
  }
  all.residual = {Rational(1, 2)};
  EXPECT_EQ(
      sentence(problem, all),
      "c0, c1, c2, c3, c4, c5, c6 and 13 more contradict each other: 1 x c0 - 1 x c1 + 1 x c2 "
      "- 1 x c3 + 1 x c4 - 1 x c5 + 1 x c6 - 1 x c7 + ... reads 0 = 1/2");
  all.residual = {0, Rational(-3)};
  EXPECT_THAT(sentence(problem, all), HasSubstr("reads (0, 0) = (0, -3)"));
}

}  // namespace
}  // namespace isochor
