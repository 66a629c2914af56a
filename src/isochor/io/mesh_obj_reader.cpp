#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>

#include "isochor/base/error.h"
#include "isochor/io/mesh_obj.h"

namespace isochor {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

class ObjReader {
 public:
  ObjReader(const std::string& text, const std::string& file) : text_(text), file_(file) {}

  Mesh read() {
    while (at_ < text_.size()) {
      const size_t end = std::min(text_.find('\n', at_), text_.size());
      line_ = std::string_view(text_).substr(at_, end - at_);
      at_ = end + 1;
      ++number_;
      statement();
    }
    if (mesh_.triangles.empty()) throw InputError(file_, "", "has no face");
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& reason) const {
    throw InputError(file_, "line " + std::to_string(number_), reason);
  }

  // The next word of the line; empty at its end or at a comment.
  std::string_view word() {
    while (!line_.empty() && is_blank(line_.front())) line_.remove_prefix(1);
    if (line_.empty() || line_.front() == '#') return {};
    size_t length = 0;
    while (length < line_.size() && !is_blank(line_[length])) ++length;
    const std::string_view found = line_.substr(0, length);
    line_.remove_prefix(length);
    return found;
  }

  void statement() {
    static constexpr std::array<std::string_view, 10> kSkipped = {
        "vt", "vn", "vp", "o", "g", "s", "usemtl", "mtllib", "l", "p"};
    const std::string_view keyword = word();
    if (keyword.empty()) return;
    if (keyword == "v") return vertex();
    if (keyword == "f") return face();
    for (const std::string_view known : kSkipped) {
      if (keyword == known) return;
    }
    fail("unknown keyword '" + std::string(keyword.substr(0, 20)) + "'");
  }

  void vertex() {
    Vec3 p;
    for (int c = 0; c < 3; ++c) p[c] = coordinate(word());
    // A weight or a colour may follow.
    mesh_.positions.push_back(p);
  }

  double coordinate(std::string_view digits) const {
    if (digits.empty()) fail("a vertex has three coordinates");
    const std::string said(digits.substr(0, 30));
    if (digits.front() == '+') digits.remove_prefix(1);
    double value = 0.0;
    const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (fault != std::errc() || end != digits.data() + digits.size() || !std::isfinite(value)) {
      fail("'" + said + "' is no coordinate");
    }
    return value;
  }

  void face() {
    corners_.clear();
    for (std::string_view corner = word(); !corner.empty(); corner = word()) {
      corners_.push_back(vertex_of(corner));
    }
    if (corners_.size() < 3) fail("a face has at least three corners");
    for (size_t k = 2; k < corners_.size(); ++k) {
      mesh_.triangles.push_back({corners_[0], corners_[k - 1], corners_[k]});
    }
  }

  // The vertex of "v", "v/vt", "v//vn" or "v/vt/vn", from 0.
  int vertex_of(std::string_view corner) const {
    const std::string said(corner.substr(0, 30));
    const std::string_view digits = corner.substr(0, corner.find('/'));
    long index = 0;
    const auto [end, fault] = std::from_chars(digits.data(), digits.data() + digits.size(), index);
    if (fault != std::errc() || end != digits.data() + digits.size()) {
      fail("'" + said + "' is no corner of a face");
    }
    const auto count = static_cast<long>(mesh_.positions.size());
    const long vertex = index > 0 ? index - 1 : count + index;
    if (index == 0 || vertex < 0 || vertex >= count ||
        vertex > std::numeric_limits<int>::max() - 1) {
      fail("'" + said + "': there are " + std::to_string(count) + " vertices so far");
    }
    return static_cast<int>(vertex);
  }

  const std::string& text_;
  const std::string& file_;
  size_t at_ = 0;
  long number_ = 0;
  std::string_view line_;  // the rest of it
  std::vector<int> corners_;
  Mesh mesh_;
};

}  // namespace

Mesh parse_obj(const std::string& text, const std::string& file) {
  return ObjReader(text, file).read();
}

}  // namespace isochor
