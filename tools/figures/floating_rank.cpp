#include "figures/floating_rank.h"

#include <Eigen/Dense>
#include <array>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "isochor/ecles/analysis.h"
#include "isochor/ecles/reference.h"

namespace figures {
namespace {

using isochor::ConstraintMatrix;
using isochor::Rational;
using isochor::RationalTerms;

constexpr int kDegree = 5;

struct Point {
  Rational x, y;
};

// Four triangles around an inner vertex, 0, between the vertices 1 to 4. Were both lines 1-0-3 and
// 2-0-4 straight, the vertex would be singular: one more constraint would be redundant. The first
// misses that by `bend`.
std::vector<Point> vertices(const Rational& bend) {
  return {{Rational(0), Rational(0)},
          {Rational(1), bend},
          {Rational(1, 4), Rational(1)},
          {Rational(-1), Rational(0)},
          {Rational(-1, 4), Rational(-1)}};
}
using Triangle = std::array<int, 3>;
constexpr std::array<Triangle, 4> kTriangles{{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}};

Rational twice_area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
}

// A point of the net, by how much of each vertex it has: shared by the triangles that touch there.
using Shares = std::map<int, int>;

struct Constraint {
  std::array<Shares, 4> points;  // of the quadrilateral: left, edge, right, edge
  RationalTerms terms;
};

struct Spline {
  std::vector<Point> vertices;
  std::vector<Shares> points;  // of the net; their values are the parameters
  std::vector<Constraint> constraints;
};

Shares shares(std::initializer_list<std::pair<int, int>> parts) {
  Shares result;
  for (const auto& [vertex, part] : parts) {
    if (part > 0) result[vertex] += part;
  }
  return result;
}

// C1 across the edge from the inner vertex to b, between a and c: with areas of the four vertices,
// (0 b a) r + (b c a) e_i + (c 0 a) e_(i+1) = (0 b c) l, row by row of the net along the edge.
std::vector<Constraint> across(const std::vector<Point>& v, int a, int b, int c,
                               std::map<Shares, int>& index) {
  const Rational of_right = twice_area(v[0], v[b], v[a]);
  const Rational of_inner = twice_area(v[b], v[c], v[a]);
  const Rational of_outer = twice_area(v[c], v[0], v[a]);
  const Rational of_left = twice_area(v[0], v[b], v[c]);
  std::vector<Constraint> result;
  for (int i = 0; i < kDegree; ++i) {
    const int rest = kDegree - 1 - i;
    Constraint constraint;
    constraint.points = {shares({{0, rest}, {b, i}, {a, 1}}), shares({{0, rest + 1}, {b, i}}),
                         shares({{0, rest}, {b, i}, {c, 1}}), shares({{0, rest}, {b, i + 1}})};
    const std::array<Rational, 4> factors{-of_left, of_inner, of_right, of_outer};
    for (size_t k = 0; k < 4; ++k) {
      constraint.terms.emplace_back(index.at(constraint.points[k]), factors[k]);
    }
    result.push_back(constraint);
  }
  return result;
}

Spline spline(const Rational& bend) {
  Spline result;
  result.vertices = vertices(bend);
  std::map<Shares, int> index;
  for (const Triangle& triangle : kTriangles) {
    for (int i = 0; i <= kDegree; ++i) {
      for (int j = 0; i + j <= kDegree; ++j) {
        const Shares point =
            shares({{triangle[0], kDegree - i - j}, {triangle[1], i}, {triangle[2], j}});
        if (index.emplace(point, static_cast<int>(result.points.size())).second) {
          result.points.push_back(point);
        }
      }
    }
  }
  for (int b = 1; b <= 4; ++b) {
    for (const Constraint& constraint :
         across(result.vertices, (b + 2) % 4 + 1, b, b % 4 + 1, index)) {
      result.constraints.push_back(constraint);
    }
  }
  return result;
}

ConstraintMatrix matrix_of(const Spline& spline) {
  std::vector<RationalTerms> rows;
  for (const Constraint& constraint : spline.constraints) rows.push_back(constraint.terms);
  return ConstraintMatrix(static_cast<int>(spline.points.size()), rows);
}

std::vector<int> all_of(int count) {
  std::vector<int> result;
  for (int k = 0; k < count; ++k) result.push_back(k);
  return result;
}

std::vector<int> independent_exactly(const ConstraintMatrix& matrix) {
  const isochor::RationalMatrix nothing(matrix.rows(), 0);
  const isochor::RationalMatrix no_values(matrix.parameters(), 0);
  return isochor::ReferenceEditor(matrix, nothing, no_values, {{}, all_of(matrix.parameters())})
      .independent();
}

// By Householder's QR of the transposed rows, each of largest entry 1, with column pivoting.
std::vector<int> independent_in_floating_point(const Spline& spline, double threshold) {
  Eigen::MatrixXd columns =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(spline.points.size()),
                            static_cast<Eigen::Index>(spline.constraints.size()));
  for (Eigen::Index i = 0; i < columns.cols(); ++i) {
    for (const auto& [point, factor] : spline.constraints[static_cast<size_t>(i)].terms) {
      columns(point, i) += factor.to_double();
    }
    columns.col(i) /= columns.col(i).cwiseAbs().maxCoeff();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  if (threshold > 0) qr.setThreshold(threshold);
  std::vector<int> kept;
  for (Eigen::Index k = 0; k < qr.rank(); ++k) {
    kept.push_back(static_cast<int>(qr.colsPermutation().indices()(k)));
  }
  return kept;
}

struct Page {
  double left;
  std::ostringstream& out;
  const Spline& spline;

  std::string place(const Shares& point) const {
    double x = 0;
    double y = 0;
    for (const auto& [vertex, part] : point) {
      const double share = static_cast<double>(part) / kDegree;
      x += share * spline.vertices[static_cast<size_t>(vertex)].x.to_double();
      y += share * spline.vertices[static_cast<size_t>(vertex)].y.to_double();
    }
    std::ostringstream text;
    text.precision(5);
    text << left + 175 + 150 * x << " " << 205 - 150 * y;
    return text.str();
  }

  void draw(const std::string& title, const std::set<int>& kept, const std::set<int>& wrong) {
    out << "<text x=\"" << left + 175 << "\" y=\"28\" text-anchor=\"middle\" font-size=\"14\" "
        << "font-weight=\"bold\">" << escaped(title) << "</text>\n";
    for (const Triangle& triangle : kTriangles) {
      out << "<path d=\"M";
      for (const int vertex : triangle) out << " " << place({{vertex, kDegree}});
      out << " Z\" fill=\"none\" stroke=\"#999999\"/>\n";
    }
    for (size_t k = 0; k < spline.constraints.size(); ++k) {
      const auto number = static_cast<int>(k);
      const bool is_kept = kept.count(number) > 0;
      const bool is_wrong = wrong.count(number) > 0;
      out << "<path d=\"M";
      for (const Shares& point : spline.constraints[k].points) out << " " << place(point);
      out << " Z\" stroke-width=\"" << (is_wrong ? 2.5 : 1.2) << "\" fill=\""
          << (is_wrong  ? "#f4b6a6"
              : is_kept ? "#c9d3e0"
                        : "none")
          << "\" stroke=\"" << (is_wrong ? "#cc2200" : "#4a5a70") << "\" fill-opacity=\"0.7\""
          << (is_kept ? "" : " stroke-dasharray=\"4 3\"") << "/>\n";
    }
    for (const Shares& point : spline.points) {
      const std::string at = place(point);
      const size_t gap = at.find(' ');
      out << "<circle r=\"2.4\" cx=\"" << at.substr(0, gap) << "\" cy=\"" << at.substr(gap + 1)
          << "\"/>\n";
    }
  }
};

std::string picture_of(const Spline& spline, const std::vector<int>& floating,
                       const std::vector<int>& exact, const std::set<int>& wrong) {
  std::ostringstream out;
  out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"740\" height=\"420\" "
      << "viewBox=\"0 0 740 420\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" "
      << "font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  Page{10, out, spline}.draw("floating point keeps " + std::to_string(floating.size()),
                             {floating.begin(), floating.end()}, wrong);
  Page{375, out, spline}.draw("independent, exactly: " + std::to_string(exact.size()),
                              {exact.begin(), exact.end()}, {});
  out << "<text x=\"370\" y=\"398\" text-anchor=\"middle\">filled: kept; dashed: discarded as "
      << "redundant; red: discarded, yet independent of all that is kept</text>\n</svg>\n";
  return out.str();
}

// The constraints that are independent of the kept ones, in order, each of those before it too.
std::set<int> missing_from(const ConstraintMatrix& matrix, const std::vector<int>& kept) {
  isochor::AnalysisOptions options;
  options.precedence.assign(static_cast<size_t>(matrix.rows()), 1);
  for (const int row : kept) options.precedence[static_cast<size_t>(row)] = 0;
  const auto analysis = isochor::analyse(matrix, {{}, all_of(matrix.parameters())}, options);
  std::set<int> result(analysis.independent.begin(), analysis.independent.end());
  for (const int row : kept) result.erase(row);
  return result;
}

}  // namespace

FloatingRank compare_floating_rank() {
  constexpr double kThesisKind = 1e-10;
  constexpr int kShown = 40;
  FloatingRank result;
  result.ranks = {"2.3  Rank of 20 constraints near a singular vertex",
                  "bits: the line is bent by 2^-bits",
                  "rank",
                  {{"exact", {}, false},
                   {"QR, its own threshold", {}, false},
                   {"QR, threshold 1e-10", {}, true}},
                  false,
                  12};
  for (int bits = 4; bits <= 72; bits += 2) {
    const Spline near = spline(Rational(1).scaled_by_power_of_two(-bits));
    const double exact = static_cast<double>(independent_exactly(matrix_of(near)).size());
    result.ranks.curves[0].points.emplace_back(bits, exact);
    result.ranks.curves[1].points.emplace_back(bits, independent_in_floating_point(near, 0).size());
    result.ranks.curves[2].points.emplace_back(
        bits, independent_in_floating_point(near, kThesisKind).size());
  }
  const Spline shown = spline(Rational(1).scaled_by_power_of_two(-kShown));
  const ConstraintMatrix matrix = matrix_of(shown);
  const std::vector<int> floating = independent_in_floating_point(shown, kThesisKind);
  const std::set<int> wrong = missing_from(matrix, floating);
  const std::vector<int> exact = independent_exactly(matrix);
  result.picture = picture_of(shown, floating, exact, wrong);
  std::ostringstream text;
  text << "bent by 2^-" << kShown << ": QR with threshold 1e-10 keeps " << floating.size() << " of "
       << matrix.rows() << " constraints, " << exact.size()
       << " are independent; discarded though independent: " << wrong.size();
  result.summary = text.str();
  return result;
}

}  // namespace figures
