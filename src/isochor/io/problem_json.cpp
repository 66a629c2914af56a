#include "isochor/io/problem_json.h"

#include <unordered_map>

#include "isochor/base/error.h"
#include "isochor/ecles/problem_text.h"
#include "isochor/io/json_reader.h"

namespace isochor {
namespace {

using internal::append;
using internal::Json;
using internal::JsonObject;
using internal::JsonValue;

// Reads the problem; knows the names of the parameters and what was remarkable.
class ProblemReader {
 public:
  explicit ProblemReader(const std::string& file) : file_(file) {}

  Problem problem;

  void read(const JsonValue& document) {
    JsonObject object(document);
    internal::check_header(object, "isochor_problem", 1);
    object.with("dimension", [&](const JsonValue& value) {
      problem.dimension = value.integer();
      if (problem.dimension < 1) value.fail("must be at least 1, found " + value.print());
    });
    each_of_list(object["parameters"], [&](const JsonValue& v) { read_parameter(v); });
    // At once, or each name in the constraints would be an unknown one.
    if (problem.parameters.empty()) object["parameters"].fail("the list is empty");
    each_of_list(object["constraints"], [&](const JsonValue& v) { read_constraint(v); });
    object.with("anchors", [&](const JsonValue& anchors) {
      each_member(anchors, [&](int parameter, const JsonValue& value) {
        problem.anchors.push_back({parameter, point(value)});
      });
    });
    object.with("derived", [&](const JsonValue& derived) {
      each_member(derived, [&](int parameter, const JsonValue& v) { read_derived(parameter, v); });
    });
    object.with("require", [&](const JsonValue& v) {
      problem.require = choice(v, {Problem::Require::kWeak, Problem::Require::kStrong});
    });
    object.with("method", [&](const JsonValue& v) {
      problem.method = choice(v, {Problem::Method::kFast, Problem::Method::kGcd,
                                  Problem::Method::kTurner, Problem::Method::kPlain});
    });
    object.finish();
  }

  std::vector<std::string> notices() const {
    if (rounded_ == 0) return {};
    return {std::to_string(rounded_) + (rounded_ == 1 ? " number is" : " numbers are") +
            " not exactly what is written, but the nearest double: first " + first_rounded_ +
            "; write it in quotes for the exact decimal"};
  }

 private:
  template <typename Each>
  static void each_of_list(const JsonValue& list, Each each) {
    for (size_t i = 0; i < list.size(); ++i) each(list.at(i));
  }

  // The members of an object whose keys are names of parameters. Goes through them once: asking
  // for each by its name would make long lists slow.
  template <typename Each>
  void each_member(const JsonValue& object, Each each) {
    if (!object.is_object()) object.fail("expected an object { ... }, found " + object.print());
    for (const auto& item : object.raw().items()) {
      const JsonValue value(item.value(), object.where() + "." + item.key(), file_);
      const auto found = parameter_of_.find(item.key());
      if (found == parameter_of_.end()) value.fail("there is no parameter \"" + item.key() + "\"");
      each(found->second, value);
    }
  }

  template <typename Choice>
  static Choice choice(const JsonValue& value, std::initializer_list<Choice> choices) {
    const std::string text = value.text();
    std::string expected;
    for (const Choice& each : choices) {
      if (text == name_of(each)) return each;
      expected += std::string(expected.empty() ? "\"" : ", \"") + name_of(each) + "\"";
    }
    value.fail("expected one of " + expected + ", found " + value.print());
  }

  Rational number(const JsonValue& value) {
    Rational result = value.rational();
    if (value.raw().is_number_float() && Rational::parse(value.raw().dump()) != result) {
      if (rounded_++ == 0) first_rounded_ = value.where() + " = " + value.print();
    }
    // Short texts can denote long numbers ("1e9999").
    constexpr unsigned long kMostBits = 1UL << 30;
    bits_ += result.numerator().bits() + result.denominator().bits();
    if (bits_ > kMostBits) value.fail("the numbers up to here need more than 128 MB");
    return result;
  }

  RationalPoint point(const JsonValue& value) {
    const auto expected = static_cast<size_t>(problem.dimension);
    if (!value.is_array() || value.size() != expected) {
      value.fail("expected a list of " + std::to_string(expected) +
                 (expected == 1 ? " number" : " numbers") + " (the dimension), found " +
                 (value.is_array() ? std::to_string(value.size()) : value.print()));
    }
    RationalPoint result;
    result.reserve(expected);
    for (size_t i = 0; i < expected; ++i) result.push_back(number(value.at(i)));
    return result;
  }

  void read_parameter(const JsonValue& value) {
    JsonObject object(value);
    const JsonValue name = object["name"];
    if (name.text().empty()) name.fail("the name is empty");
    Problem::Parameter parameter{name.text(), point(object["value"])};
    object.finish();
    if (!parameter_of_.emplace(parameter.name, problem.parameters.size()).second) {
      name.fail("another parameter has the name " + name.print());
    }
    problem.parameters.push_back(std::move(parameter));
  }

  void read_constraint(const JsonValue& value) {
    JsonObject object(value);
    Problem::Constraint constraint{object["name"].text(), {}, {}};
    each_member(object["terms"], [&](int parameter, const JsonValue& coefficient) {
      constraint.terms.emplace_back(parameter, number(coefficient));
    });
    constraint.equals = point(object["equals"]);
    object.finish();
    problem.constraints.push_back(std::move(constraint));
  }

  void read_derived(int parameter, const JsonValue& value) {
    JsonObject object(value);
    Problem::Derived derived{parameter, problem.parameters[static_cast<size_t>(parameter)].value,
                             1};
    object.with("hint", [&](const JsonValue& hint) { derived.hint = point(hint); });
    object.with("weight", [&](const JsonValue& weight) { derived.weight = number(weight); });
    object.finish();
    problem.derived.push_back(std::move(derived));
  }

  const std::string& file_;
  std::unordered_map<std::string, int> parameter_of_;
  unsigned long bits_ = 0;
  int rounded_ = 0;
  std::string first_rounded_;
};

Json exact(const RationalPoint& point) {
  Json list = Json::array();
  for (const Rational& number : point) list.push_back(number.to_string());
  return list;
}

Value exact_value(const RationalPoint& point) {
  Value list = Value::list();
  for (const Rational& number : point) list.push(number.to_string());
  return list;
}

// What combinations look like: "constraints", "multipliers", "residual", "text".
class SolutionWriter {
 public:
  explicit SolutionWriter(const Problem& problem) : problem_(problem) {}

  const std::string& parameter(int j) const {
    return problem_.parameters[static_cast<size_t>(j)].name;
  }
  const std::string& constraint(int i) const {
    return problem_.constraints[static_cast<size_t>(i)].name;
  }

  Value names(const std::vector<int>& constraints) const {
    Value list = Value::list();
    for (int i : constraints) list.push(constraint(i));
    return list;
  }

  Value combination(const Combination& combination) const {
    Value constraints = Value::list(), multipliers = Value::list(), anchors = Value::object();
    for (const auto& [i, multiplier] : combination.multipliers) {
      constraints.push(constraint(i));
      multipliers.push(multiplier.to_string());
    }
    for (const auto& [j, coefficient] : combination.anchors) {
      anchors.set(parameter(j), coefficient.to_string());
    }
    return Value::object()
        .set("constraints", constraints)
        .set("multipliers", multipliers)
        .set("anchors", anchors)
        .set("residual", exact_value(combination.residual))
        .set("text", sentence(problem_, combination));
  }

  Value combinations(const std::vector<Combination>& all) const {
    Value list = Value::list();
    for (const Combination& each : all) list.push(combination(each));
    return list;
  }

  Value violations(const std::vector<Violation>& all) const {
    Value list = Value::list();
    for (const Violation& each : all) {
      list.push(Value::object()
                    .set("constraint", constraint(each.constraint))
                    .set("relevant", each.relevant)
                    .set("residual", exact_value(each.residual)));
    }
    return list;
  }

  Value values(const Solution& solution) const {
    Value object = Value::object();
    for (size_t j = 0; j < solution.values.size(); ++j) {
      object.set(problem_.parameters[j].name, exact_value(solution.values[j]));
    }
    return object;
  }

 private:
  const Problem& problem_;
};

}  // namespace

ProblemFile parse_problem(const std::string& text, const std::string& file) {
  const Json document = internal::parse_json(text, file);
  ProblemReader reader(file);
  reader.read(JsonValue(document, "", file));
  try {
    reader.problem.validate();
  } catch (const InputError& error) {
    throw error.in_file(file);
  }
  return {std::move(reader.problem), reader.notices()};
}

std::string format_problem(const Problem& problem) {
  const auto name_at = [&](int j) { return problem.parameters[static_cast<size_t>(j)].name; };
  Json document{{"isochor_problem", 1}, {"dimension", problem.dimension}};
  Json& parameters = document["parameters"] = Json::array();
  for (const auto& parameter : problem.parameters) {
    parameters.push_back({{"name", parameter.name}, {"value", exact(parameter.value)}});
  }
  Json& constraints = document["constraints"] = Json::array();
  for (const auto& constraint : problem.constraints) {
    Json terms = Json::object();
    for (const auto& [j, coefficient] : constraint.terms) {
      append(terms, name_at(j), coefficient.to_string());
    }
    constraints.push_back({{"name", constraint.name},
                           {"terms", std::move(terms)},
                           {"equals", exact(constraint.equals)}});
  }
  Json& anchors = document["anchors"] = Json::object();
  for (const auto& anchor : problem.anchors) {
    append(anchors, name_at(anchor.parameter), exact(anchor.value));
  }
  Json& derived = document["derived"] = Json::object();
  for (const auto& each : problem.derived) {
    append(derived, name_at(each.parameter),
           {{"hint", exact(each.hint)}, {"weight", each.weight.to_string()}});
  }
  document["require"] = name_of(problem.require);
  document["method"] = name_of(problem.method);
  return document.dump(1) + "\n";
}

Value solution_value(const Problem& problem, const Solution& solution,
                     const std::vector<std::string>& notices) {
  const SolutionWriter writer(problem);
  Value redundant = Value::list(), because = Value::list();
  for (const Redundancy& each : solution.redundant) {
    redundant.push(writer.constraint(each.constraint));
    because.push(writer.combination(each.because));
  }
  return Value::object()
      .set("isochor_solution", 1)
      .set("outcome", name_of(solution.outcome))
      .set("reason", solution.reason)
      .set("values", writer.values(solution))
      .set("rank", solution.rank)
      .set("freedom_left", solution.freedom_left)
      .set("relevant", writer.names(solution.relevant))
      .set("redundant", redundant)
      .set("redundant_because", because)
      .set("conflicts", writer.combinations(solution.conflicts))
      .set("strongly_solvable", solution.strongly_solvable)
      .set("obstructions", writer.combinations(solution.obstructions))
      .set("violated_before", writer.violations(solution.violated_before))
      .set("proofs_verified", solution.proofs_verified)
      .set("notices", notices);
}

}  // namespace isochor
