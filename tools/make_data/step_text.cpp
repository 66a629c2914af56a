#include "make_data/step_text.h"

#include <charconv>
#include <cmath>

namespace make_data {

namespace {

std::string ref(int id) { return "#" + std::to_string(id); }

template <typename Range, typename Print>
std::string list(const Range& range, Print print) {
  std::string text = "(";
  for (const auto& item : range) {
    if (text.size() > 1) text += ",";
    text += print(item);
  }
  return text + ")";
}

std::string refs(const std::vector<int>& ids) { return list(ids, ref); }
std::string quoted(const std::string& text) { return "'" + text + "'"; }

// "(multiplicities),(knots)"
std::pair<std::string, std::string> knots_and_multiplicities(const KnotVector& knots) {
  std::vector<double> distinct;
  std::vector<int> counts;
  for (double knot : knots.knots()) {
    if (distinct.empty() || distinct.back() != knot) {
      distinct.push_back(knot);
      counts.push_back(0);
    }
    ++counts.back();
  }
  return {list(counts, [](int count) { return std::to_string(count); }), list(distinct, step_real)};
}

std::string curve_body(const KnotVector& knots, const std::vector<int>& poles) {
  const auto [multiplicities, values] = knots_and_multiplicities(knots);
  return "B_SPLINE_CURVE_WITH_KNOTS(''," + std::to_string(knots.degree()) + "," + refs(poles) +
         ",.UNSPECIFIED.,.F.,.F.," + multiplicities + "," + values + ",.UNSPECIFIED.)";
}

}  // namespace

std::string step_real(double value) {
  std::array<char, 40> buffer;
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  std::string text(buffer.data(), end);
  const size_t exponent = text.find('e');
  std::string mantissa = text.substr(0, exponent);
  if (mantissa.find('.') == std::string::npos) mantissa += ".";
  return exponent == std::string::npos ? mantissa : mantissa + "E" + text.substr(exponent + 1);
}

Pcurve straight_pcurve(int surface, Uv start, Uv direction) {
  return {surface, {}, {start, direction}};
}

Pcurve spline_pcurve(int surface, const KnotVector& knots, std::vector<Uv> poles) {
  return {surface, {knots}, std::move(poles)};
}

StepText::StepText(std::string name, std::string description, std::string unit)
    : name_(std::move(name)), description_(std::move(description)), unit_(std::move(unit)) {}

int StepText::add(const std::string& body) {
  lines_.push_back(body);
  return static_cast<int>(lines_.size());
}

int StepText::shared(const std::string& body) {
  const auto [place, fresh] = known_.emplace(body, 0);
  if (fresh) place->second = add(body);
  return place->second;
}

int StepText::point(const Vec3& p) {
  return shared("CARTESIAN_POINT(''," +
                list(std::array<double, 3>{p.x(), p.y(), p.z()}, step_real) + ")");
}

int StepText::point2(Uv p) {
  return shared("CARTESIAN_POINT(''," + list(std::array<double, 2>{p.u, p.v}, step_real) + ")");
}

int StepText::direction(const Vec3& d) {
  return shared("DIRECTION(''," + list(std::array<double, 3>{d.x(), d.y(), d.z()}, step_real) +
                ")");
}

int StepText::vertex(const Vec3& p) { return add("VERTEX_POINT(''," + ref(point(p)) + ")"); }

int StepText::surface(const Surface& s, bool u_closed, bool v_closed) {
  std::string rows;
  for (int i = 0; i < s.u_size(); ++i) {
    std::vector<int> row;
    for (int j = 0; j < s.v_size(); ++j) row.push_back(point(s.pole(i, j)));
    rows += (i > 0 ? ",\n" : "\n") + refs(row);
  }
  const auto [u_multiplicities, u_values] = knots_and_multiplicities(s.u_knots());
  const auto [v_multiplicities, v_values] = knots_and_multiplicities(s.v_knots());
  return add("B_SPLINE_SURFACE_WITH_KNOTS(''," + std::to_string(s.u_knots().degree()) + "," +
             std::to_string(s.v_knots().degree()) + ",(" + rows + "),.UNSPECIFIED.," +
             (u_closed ? ".T." : ".F.") + "," + (v_closed ? ".T." : ".F.") + ",.F.," +
             u_multiplicities + "," + v_multiplicities + "," + u_values + "," + v_values +
             ",.UNSPECIFIED.)");
}

int StepText::plane(const Vec3& origin, const Vec3& normal, const Vec3& x_axis) {
  const int axes = add("AXIS2_PLACEMENT_3D(''," + ref(point(origin)) + "," +
                       ref(direction(normal)) + "," + ref(direction(x_axis)) + ")");
  return add("PLANE(''," + ref(axes) + ")");
}

int StepText::pcurve(const Pcurve& p) {
  const int context = shared(
      "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()"
      "REPRESENTATION_CONTEXT('parameters',''))");
  int curve = 0;
  if (p.knots.empty()) {
    const double length = std::hypot(p.poles[1].u, p.poles[1].v);
    const int along = shared(
        "DIRECTION(''," +
        list(std::array<double, 2>{p.poles[1].u / length, p.poles[1].v / length}, step_real) + ")");
    const int vector = shared("VECTOR(''," + ref(along) + "," + step_real(length) + ")");
    curve = shared("LINE(''," + ref(point2(p.poles[0])) + "," + ref(vector) + ")");
  } else {
    std::vector<int> poles;
    for (Uv pole : p.poles) poles.push_back(point2(pole));
    curve = add(curve_body(p.knots[0], poles));
  }
  const int representation =
      add("DEFINITIONAL_REPRESENTATION(''," + refs({curve}) + "," + ref(context) + ")");
  return add("PCURVE(''," + ref(p.surface) + "," + ref(representation) + ")");
}

int StepText::edge_curve(int begin, int end, int curve, const std::vector<Pcurve>& pcurves,
                         bool seam) {
  std::vector<int> ids;
  for (const Pcurve& p : pcurves) ids.push_back(pcurve(p));
  const int both = add(std::string(seam ? "SEAM_CURVE" : "SURFACE_CURVE") + "(''," + ref(curve) +
                       "," + refs(ids) + ",.CURVE_3D.)");
  return add("EDGE_CURVE(''," + ref(begin) + "," + ref(end) + "," + ref(both) + ",.T.)");
}

int StepText::edge(int begin, int end, const Curve& curve, const std::vector<Pcurve>& pcurves,
                   bool seam) {
  std::vector<int> poles;
  for (const Vec3& pole : curve.poles) poles.push_back(point(pole));
  return edge_curve(begin, end, add(curve_body(curve.knots, poles)), pcurves, seam);
}

int StepText::straight_edge(int begin, int end, const Vec3& from, const Vec3& to,
                            const std::vector<Pcurve>& pcurves) {
  const int vector = add("VECTOR(''," + ref(direction((to - from).normalized())) + ",1.)");
  return edge_curve(begin, end, add("LINE(''," + ref(point(from)) + "," + ref(vector) + ")"),
                    pcurves, false);
}

void StepText::face(const std::string& name, int surface,
                    const std::vector<std::vector<Use>>& loops, const Rgb& colour, bool reversed) {
  std::vector<int> bounds;
  for (const std::vector<Use>& loop : loops) {
    std::vector<int> uses;
    for (const Use& use : loop) {
      uses.push_back(
          add("ORIENTED_EDGE('',*,*," + ref(use.edge) + (use.forward ? ",.T.)" : ",.F.)")));
    }
    const int id = add("EDGE_LOOP(''," + refs(uses) + ")");
    bounds.push_back(
        add((bounds.empty() ? "FACE_OUTER_BOUND(''," : "FACE_BOUND('',") + ref(id) + ",.T.)"));
  }
  faces_.push_back(add("ADVANCED_FACE(" + quoted(name) + "," + refs(bounds) + "," + ref(surface) +
                       (reversed ? ",.F.)" : ",.T.)")));
  colours_.push_back(colour);
}

int StepText::add_product() {
  const int shell =
      add(std::string(open_ ? "OPEN_SHELL" : "CLOSED_SHELL") + "(''," + refs(faces_) + ")");
  const int body =
      open_ ? add("SHELL_BASED_SURFACE_MODEL(" + quoted(name_) + "," + refs({shell}) + ")")
            : add("MANIFOLD_SOLID_BREP(" + quoted(name_) + "," + ref(shell) + ")");
  const int axes = add("AXIS2_PLACEMENT_3D(''," + ref(point(Vec3::Zero())) + "," +
                       ref(direction(Vec3::UnitZ())) + "," + ref(direction(Vec3::UnitX())) + ")");
  const int length = add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT($,." + unit_ + ".))");
  const int angle = add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const int solid_angle = add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const int accuracy = add("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07)," + ref(length) +
                           ",'distance_accuracy_value','')");
  const int context =
      add("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(" +
          refs({accuracy}) + ")GLOBAL_UNIT_ASSIGNED_CONTEXT(" + refs({length, angle, solid_angle}) +
          ")REPRESENTATION_CONTEXT('model','3D'))");
  const std::string kind =
      open_ ? "MANIFOLD_SURFACE_SHAPE_REPRESENTATION" : "ADVANCED_BREP_SHAPE_REPRESENTATION";
  const int shape =
      add(kind + "(" + quoted(name_) + "," + refs({axes, body}) + "," + ref(context) + ")");
  const int application = add("APPLICATION_CONTEXT('managed model based 3d engineering')");
  add("APPLICATION_PROTOCOL_DEFINITION('international standard',"
      "'ap242_managed_model_based_3d_engineering',2014," +
      ref(application) + ")");
  const int product_context = add("PRODUCT_CONTEXT(''," + ref(application) + ",'mechanical')");
  const int product = add("PRODUCT(" + quoted(name_) + "," + quoted(name_) + "," +
                          quoted(description_) + "," + refs({product_context}) + ")");
  add("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$," + refs({product}) + ")");
  const int formation = add("PRODUCT_DEFINITION_FORMATION('',''," + ref(product) + ")");
  const int stage =
      add("PRODUCT_DEFINITION_CONTEXT('part definition'," + ref(application) + ",'design')");
  const int definition =
      add("PRODUCT_DEFINITION('design',''," + ref(formation) + "," + ref(stage) + ")");
  const int definition_shape = add("PRODUCT_DEFINITION_SHAPE('',''," + ref(definition) + ")");
  add("SHAPE_DEFINITION_REPRESENTATION(" + ref(definition_shape) + "," + ref(shape) + ")");
  return context;
}

void StepText::add_colours(int context) {
  std::vector<int> styled;
  for (size_t i = 0; i < faces_.size(); ++i) {
    const int colour = shared("COLOUR_RGB(''," + step_real(colours_[i][0]) + "," +
                              step_real(colours_[i][1]) + "," + step_real(colours_[i][2]) + ")");
    const int fill = shared("FILL_AREA_STYLE_COLOUR(''," + ref(colour) + ")");
    const int area = shared("FILL_AREA_STYLE(''," + refs({fill}) + ")");
    const int surface_fill = shared("SURFACE_STYLE_FILL_AREA(" + ref(area) + ")");
    const int side = shared("SURFACE_SIDE_STYLE(''," + refs({surface_fill}) + ")");
    const int usage = shared("SURFACE_STYLE_USAGE(.BOTH.," + ref(side) + ")");
    const int style = shared("PRESENTATION_STYLE_ASSIGNMENT(" + refs({usage}) + ")");
    styled.push_back(add("STYLED_ITEM('colour'," + refs({style}) + "," + ref(faces_[i]) + ")"));
  }
  add("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION(''," + refs(styled) + "," +
      ref(context) + ")");
}

std::string StepText::text() const {
  StepText all = *this;  // the entities around the faces go at the end
  all.add_colours(all.add_product());
  std::string text =
      "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((" + quoted(description_) + "),'2;1');\n" +
      "FILE_NAME(" + quoted(name_) +
      ",'2025-01-01T00:00:00',('Isochor'),('Isochor'),'isochor_make_data','isochor_make_data','');"
      "\n"
      "FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }'));\n"
      "ENDSEC;\nDATA;\n";
  for (size_t i = 0; i < all.lines_.size(); ++i) {
    text += ref(static_cast<int>(i) + 1) + "=" + all.lines_[i] + ";\n";
  }
  return text + "ENDSEC;\nEND-ISO-10303-21;\n";
}

}  // namespace make_data
