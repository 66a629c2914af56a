#include "isochor/io/problem_json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "isochor/base/error.h"

namespace isochor {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;
using Json = nlohmann::ordered_json;

// The example of the contract.
const char* const kPumps = R"({"isochor_problem": 1, "dimension": 1,
  "parameters": [{"name": "p1", "value": [1]}, {"name": "p2", "value": [2]},
                 {"name": "p3", "value": [3]}, {"name": "p4", "value": [8]}],
  "constraints": [{"name": "join", "terms": {"p1": 1, "p2": 1, "p3": -1}, "equals": [0]},
                  {"name": "offset", "terms": {"p4": 1, "p3": -1}, "equals": [5]}],
  "anchors": {"p1": [4]}, "derived": {"p3": {"hint": [3], "weight": 1}, "p4": {"hint": [8]}},
  "require": "weak", "method": "fast"})";

Problem parsed(const Json& document) { return parse_problem(document.dump(), "p.json").problem; }

// The error of the example with the value at a JSON pointer replaced.
std::string error_of(const std::string& place, const Json& value) {
  Json document = Json::parse(kPumps);
  document[Json::json_pointer(place)] = value;
  try {
    parse_problem(document.dump(), "p.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

std::string error_without(const std::string& key) {
  Json document = Json::parse(kPumps);
  document.erase(key);
  try {
    parsed(document);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ProblemJson, ReadsTheContractsExample) {
  const ProblemFile file = parse_problem(kPumps, "p.json");
  const Problem& problem = file.problem;
  EXPECT_THAT(file.notices, IsEmpty());
  EXPECT_EQ(problem.dimension, 1);
  ASSERT_EQ(problem.parameters.size(), 4u);
  EXPECT_EQ(problem.parameters[3].name, "p4");
  EXPECT_THAT(problem.parameters[3].value, ElementsAre(Rational(8)));
  ASSERT_EQ(problem.constraints.size(), 2u);
  EXPECT_EQ(problem.constraints[1].name, "offset");
  EXPECT_THAT(problem.constraints[1].terms,
              ElementsAre(std::pair(3, Rational(1)), std::pair(2, Rational(-1))));
  EXPECT_THAT(problem.constraints[1].equals, ElementsAre(Rational(5)));
  ASSERT_EQ(problem.anchors.size(), 1u);
  EXPECT_EQ(problem.anchors[0].parameter, 0);
  ASSERT_EQ(problem.derived.size(), 2u);
  EXPECT_EQ(problem.derived[1].weight, Rational(1));
  EXPECT_EQ(problem.require, Problem::Require::kWeak);
  EXPECT_EQ(problem.method, Problem::Method::kFast);
}

TEST(ProblemJson, DefaultsAreTheCurrentValueOneWeakAndFast) {
  Json document = Json::parse(kPumps);
  for (const char* key : {"dimension", "require", "method", "anchors"}) document.erase(key);
  document["derived"] = {{"p2", Json::object()}};
  document["requires"] = Json::array();
  const Problem problem = parsed(document);
  EXPECT_EQ(problem.dimension, 1);
  EXPECT_THAT(problem.anchors, IsEmpty());
  ASSERT_EQ(problem.derived.size(), 1u);
  EXPECT_THAT(problem.derived[0].hint, ElementsAre(Rational(2)));
  EXPECT_EQ(problem.derived[0].weight, Rational(1));
  EXPECT_EQ(problem.require, Problem::Require::kWeak);
}

TEST(ProblemJson, FormatThenParseIsTheSame) {
  Json document = Json::parse(kPumps);
  document["require"] = "strong";
  document["anchors"]["p1"] = {"-22/7"};
  document["derived"]["p3"]["weight"] = 0.1;
  document["constraints"][0]["terms"]["p2"] = "1e-30";
  const std::string once = format_problem(parsed(document));
  EXPECT_EQ(once, format_problem(parse_problem(once, "p.json").problem));
  EXPECT_THAT(once, HasSubstr("\"-22/7\""));
  EXPECT_THAT(once, HasSubstr("\"3602879701896397/36028797018963968\""));
  EXPECT_THAT(once, HasSubstr("\"1/1000000000000000000000000000000\""));
  EXPECT_THAT(once, HasSubstr("\"require\": \"strong\""));
}

TEST(ProblemJson, NumbersThatAreNotWhatIsWrittenAreNoticed) {
  Json document = Json::parse(kPumps);
  document["constraints"][0]["terms"]["p1"] = 0.5;
  document["constraints"][0]["terms"]["p2"] = "0.1";
  EXPECT_THAT(parse_problem(document.dump(), "p").notices, IsEmpty());
  document["constraints"][0]["terms"]["p3"] = 0.1;
  EXPECT_THAT(parse_problem(document.dump(), "p").notices,
              ElementsAre(StartsWith("1 number is not exactly what is written, but the nearest "
                                     "double: first constraints[0].terms.p3 = 0.1; ")));
  document["anchors"]["p1"] = {1e-3};
  EXPECT_THAT(parse_problem(document.dump(), "p").notices,
              ElementsAre(StartsWith("2 numbers are")));
}

TEST(ProblemJson, MistakesNameThePlaceAndTheValue) {
  EXPECT_EQ(error_of("/constraints/0/terms/p9", 1),
            "p.json: constraints[0].terms.p9: there is no parameter \"p9\"");
  EXPECT_EQ(error_of("/anchors/p9", {1}), "p.json: anchors.p9: there is no parameter \"p9\"");
  EXPECT_EQ(error_of("/derived/p9", Json::object()),
            "p.json: derived.p9: there is no parameter \"p9\"");
  EXPECT_EQ(error_of("/derived/p3/weight", 0),
            "p.json: derived.p3.weight: a weight must be positive, found 0");
  EXPECT_EQ(error_of("/derived/p3/weight", "-1/2"),
            "p.json: derived.p3.weight: a weight must be positive, found -1/2");
  EXPECT_EQ(error_of("/derived/p1", Json::object()),
            "p.json: derived.p1: the parameter is already an anchor or derived; it can be only one "
            "of them");
  EXPECT_EQ(error_of("/derived/p3/hint", {1, 2}),
            "p.json: derived.p3.hint: expected a list of 1 number (the dimension), found 2");
  EXPECT_EQ(error_of("/anchors/p1", 4),
            "p.json: anchors.p1: expected a list of 1 number (the dimension), found 4");
  EXPECT_EQ(error_of("/dimension", 2),
            "p.json: parameters[0].value: expected a list of 2 numbers (the dimension), found 1");
  EXPECT_THAT(error_of("/dimension", 0), HasSubstr("dimension: must be at least 1, found 0"));
  EXPECT_THAT(error_of("/dimension", 1.5), HasSubstr("dimension: expected an integer"));
  EXPECT_THAT(error_of("/parameters/1/name", "p1"),
              HasSubstr("parameters[1].name: another parameter has the name \"p1\""));
  EXPECT_THAT(error_of("/parameters/1/name", 7), HasSubstr("parameters[1].name: expected a text"));
  EXPECT_THAT(error_of("/parameters/1/name", ""), HasSubstr("parameters[1].name: the name is emp"));
  EXPECT_THAT(error_of("/constraints/1/name", "join"), HasSubstr("\"join\" occurs twice"));
  EXPECT_THAT(error_of("/parameters/1/value", {"NaN"}), HasSubstr("parameters[1].value[0]: "));
  EXPECT_THAT(error_of("/parameters/1/value", {true}), HasSubstr("expected a number, found true"));
  EXPECT_THAT(error_of("/parameters/1/value", {nullptr}), HasSubstr("parameters[1].value[0]: "));
  EXPECT_THAT(error_of("/constraints/0/equals", {"1/0"}),
              HasSubstr("constraints[0].equals[0]: the denominator is zero"));
  EXPECT_THAT(error_of("/require", "firm"), HasSubstr("require: expected one of \"weak\", "));
  EXPECT_THAT(error_of("/method", "slow"), HasSubstr("method: expected one of \"fast\", "));
  EXPECT_THAT(error_of("/isochor_problem", 2), HasSubstr("version 2 is not known"));
  EXPECT_THAT(error_of("/requires", {"warp"}), HasSubstr("requires \"warp\""));
}

TEST(ProblemJson, UnknownAndMissingKeysAreNamed) {
  EXPECT_EQ(error_of("/anchor", Json::object()), "p.json: unknown key \"anchor\"");
  EXPECT_EQ(error_of("/parameters/0/vlaue", 1), "p.json: parameters[0]: unknown key \"vlaue\"");
  EXPECT_EQ(error_of("/constraints/0/equal", 1), "p.json: constraints[0]: unknown key \"equal\"");
  EXPECT_EQ(error_of("/derived/p3/wieght", 1), "p.json: derived.p3: unknown key \"wieght\"");
  EXPECT_THAT(error_without("parameters"), HasSubstr("the key \"parameters\" is missing"));
  EXPECT_THAT(error_without("constraints"), HasSubstr("the key \"constraints\" is missing"));
  EXPECT_THAT(error_without("isochor_problem"), HasSubstr("not an isochor_problem file"));
}

TEST(ProblemJson, EmptySetsAreNamed) {
  EXPECT_THAT(error_of("/constraints", Json::array()), HasSubstr("constraints: the list is empty"));
  EXPECT_THAT(error_of("/constraints/0/terms", Json::object()),
              HasSubstr("constraints[0].terms: the constraint \"join\" has no terms"));
  EXPECT_THAT(error_of("/parameters", Json::array()), HasSubstr("parameters: the list is empty"));
  Json document = Json::parse(kPumps);
  document["anchors"] = document["derived"] = Json::object();
  EXPECT_THROW(parsed(document), InputError);
  for (const char* list : {"parameters", "constraints"}) {
    EXPECT_THAT(error_of(std::string("/") + list, Json::object()), HasSubstr("expected a list"));
  }
  EXPECT_THAT(error_of("/anchors", Json::array()), HasSubstr("anchors: expected an object"));
}

TEST(ProblemJson, ShortTextsOfHugeNumbersHaveALimit) {
  Json document = Json::parse(kPumps);
  document["dimension"] = 40'000;
  document["parameters"][0]["value"] = Json::array();
  for (int i = 0; i < 40'000; ++i) document["parameters"][0]["value"].push_back("1e9999");
  try {
    parsed(document);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("the numbers up to here need more than 128 MB"));
  }
}

TEST(ProblemJson, SolutionHasTheKeysOfTheContract) {
  const Problem problem = parse_problem(kPumps, "p.json").problem;
  const Json solution = Json::parse(to_json(solution_value(problem, solve(problem), {"a notice"})));
  EXPECT_EQ(solution["isochor_solution"], 1);
  EXPECT_EQ(solution["outcome"], "solved");
  EXPECT_EQ(solution["values"].dump(), R"({"p1":["4"],"p2":["2"],"p3":["6"],"p4":["11"]})");
  EXPECT_EQ(solution["rank"], 2);
  EXPECT_EQ(solution["freedom_left"], 0);
  EXPECT_EQ(solution["relevant"].dump(), R"(["join","offset"])");
  for (const char* empty : {"redundant", "conflicts", "obstructions", "violated_before"}) {
    EXPECT_EQ(solution[empty], Json::array()) << empty;
  }
  EXPECT_EQ(solution["strongly_solvable"], true);
  EXPECT_EQ(solution["proofs_verified"], true);
  EXPECT_EQ(solution["notices"].dump(), R"(["a notice"])");
}

TEST(ProblemJson, SolutionNamesCulprits) {
  Json document = Json::parse(kPumps);
  document["constraints"].push_back(
      {{"name", "again"}, {"terms", {{"p4", 2}, {"p3", -2}}}, {"equals", {10}}});
  document["constraints"].push_back(
      {{"name", "wrong"}, {"terms", {{"p4", "1/2"}, {"p3", "-1/2"}}}, {"equals", {1}}});
  const Problem problem = parsed(document);
  const Json solution = Json::parse(to_json(solution_value(problem, solve(problem))));
  EXPECT_EQ(solution["outcome"], "not_weakly_solvable");
  EXPECT_EQ(solution["values"], Json::object());
  EXPECT_EQ(solution["redundant"].dump(), R"(["offset"])");  // again comes first by name
  ASSERT_EQ(solution["conflicts"].size(), 1u);
  EXPECT_EQ(solution["conflicts"][0]["constraints"].dump(), R"(["again","wrong"])");
  EXPECT_EQ(solution["conflicts"][0]["multipliers"].dump(), R"(["1","-4"])");
  EXPECT_EQ(solution["conflicts"][0]["residual"].dump(), R"(["6"])");
  EXPECT_EQ(solution["conflicts"][0]["text"],
            "again and wrong contradict each other: 1 x again - 4 x wrong reads 0 = 6");
  ASSERT_EQ(solution["violated_before"].size(), 1u);
  EXPECT_EQ(solution["violated_before"][0]["constraint"], "wrong");
  EXPECT_EQ(solution["violated_before"][0]["relevant"], true);
}

}  // namespace
}  // namespace isochor
