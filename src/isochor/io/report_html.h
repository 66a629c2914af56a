// The report of a run as one web page for people: what was asked, what it cost, what is proven.
//
// The page stands alone: styles and the picture are inside it, and it loads nothing.
#pragma once

#include <string>
#include <vector>

#include "isochor/edit/certificate.h"

namespace isochor {

struct HtmlReport {
  std::string model;  // the file that was edited
  std::string unit;
  Outcome outcome = Outcome::kDone;
  std::string refusal;  // when the outcome is not that of an edit: why
  std::vector<Certificate> edits;
  std::vector<std::string> checks;  // sentences about the written file
  std::string picture_png;          // bytes of a PNG file, or empty
  std::string json;                 // the whole report, shown at the end
};

// UTF-8; every text from outside is escaped.
std::string format_html(const HtmlReport& report);

// RFC 4648, with padding.
std::string base64(const std::string& bytes);

}  // namespace isochor
