#include "isochor/io/report_html.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <utility>

namespace isochor {
namespace {

constexpr char kStyle[] = R"(
  body { font: 16px/1.5 system-ui, sans-serif; color: #1f2933; max-width: 1100px;
         margin: 2rem auto; padding: 0 1rem; }
  h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2rem; }
  img { max-width: 100%; border: 1px solid #d5dae0; }
  table { border-collapse: collapse; } td, th { padding: .25rem 1.25rem .25rem 0; text-align: left;
         vertical-align: top; border-bottom: 1px solid #e4e8ec; font-weight: normal; }
  th { color: #5b6773; } td { font-variant-numeric: tabular-nums; }
  .done { color: #17693a; } .no { color: #a12622; }
  pre { background: #f5f7f9; padding: 1rem; overflow-x: auto; font-size: 13px; }
)";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string number(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

std::string vector(const Vec3& v) {
  return "(" + number(v.x(), 6) + ", " + number(v.y(), 6) + ", " + number(v.z(), 6) + ")";
}

using Rows = std::vector<std::pair<std::string, std::string>>;

std::string table(const Rows& rows) {
  std::string out = "<table>\n";
  for (const auto& [what, value] : rows) {
    out += "<tr><th>" + escaped(what) + "</th><td>" + escaped(value) + "</td></tr>\n";
  }
  return out + "</table>\n";
}

std::string verdict(Outcome outcome) {
  const char* kind = outcome == Outcome::kDone ? "done" : "no";
  return std::string("<span class=\"") + kind + "\">" + std::string(name_of(outcome)) + "</span>";
}

Rows rows_of(const Certificate& edit, const std::string& unit) {
  const std::string length = " " + unit, volume = " " + unit + "\u00b3";
  Rows rows = {{"volume before", number(edit.volume.before, 15) + volume},
               {"volume after", number(edit.volume.after, 15) + volume},
               {"relative change", number(edit.volume.relative_change, 3) + ", error at most " +
                                       number(edit.volume.bound, 2)}};
  for (const MoveRecord& move : edit.moves) {
    rows.emplace_back("moved " + move.place, "by " + vector(move.got) + length + ", off by " +
                                                 number(move.error, 2) + length);
  }
  for (const MoveRecord& hold : edit.holds) {
    rows.emplace_back("held " + hold.place, "off by " + number(hold.error, 2) + length);
  }
  if (edit.joins.count > 0) {
    rows.emplace_back("joins", std::to_string(edit.joins.count) + ", largest gap " +
                                   number(edit.joins.max_gap, 3) + length);
  }
  rows.emplace_back("freedom", std::to_string(edit.coefficients) + " coefficients in the extent, " +
                                   std::to_string(edit.rank) + " equations, " +
                                   std::to_string(edit.freedom_left) + " left");
  rows.emplace_back("moved poles", std::to_string(edit.poles_moved) + ", at most by " +
                                       number(edit.max_distance, 4) + length);
  for (const LockRecord& lock : edit.locked) {
    rows.emplace_back("locked", std::to_string(lock.coefficients) + " coefficients of " +
                                    lock.patch + ": " + lock.reason);
  }
  return rows;
}

std::string section(const Certificate& edit, const std::string& unit) {
  std::string out = "<h2>" + escaped(edit.name) + ": " + verdict(edit.outcome) + "</h2>\n";
  if (edit.outcome != Outcome::kDone) return out + "<p>" + escaped(edit.reason) + "</p>\n";
  return out + table(rows_of(edit, unit));
}

}  // namespace

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t have = std::min<size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < have ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (size_t k = 0; k < 4; ++k) {
      out += k <= have ? kDigits[group >> (18 - 6 * k) & 63u] : '=';
    }
  }
  return out;
}

std::string format_html(const HtmlReport& report) {
  const std::string title = escaped("Edits of " + report.model);
  std::string out =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>" + title +
      "</title>\n<style>" + kStyle + "</style>\n</head>\n<body>\n<h1>" + title + ": " +
      verdict(report.outcome) + "</h1>\n";
  if (!report.refusal.empty()) out += "<p>" + escaped(report.refusal) + "</p>\n";
  if (!report.picture_png.empty()) {
    out += "<img alt=\"before, after and displacement\" src=\"data:image/png;base64," +
           base64(report.picture_png) + "\">\n";
  }
  for (const Certificate& edit : report.edits) out += section(edit, report.unit);
  if (!report.checks.empty()) {
    out += "<h2>The written file, read back</h2>\n<ul>\n";
    for (const std::string& check : report.checks) out += "<li>" + escaped(check) + "</li>\n";
    out += "</ul>\n";
  }
  return out + "<details><summary>The whole report</summary><pre>" + escaped(report.json) +
         "</pre></details>\n</body>\n</html>\n";
}

}  // namespace isochor
