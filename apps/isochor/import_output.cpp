#include "import_output.h"

#include "terminal.h"

namespace isochor::app {
namespace {

constexpr size_t kListed = 8;

Value to_value(const ShapeCounts& counts) {
  return Value::object()
      .set("solids", counts.solids)
      .set("shells", counts.shells)
      .set("faces", counts.faces);
}

Value to_value(const std::vector<std::pair<std::string, int>>& counts) {
  Value list = Value::list();
  for (const auto& [text, count] : counts) {
    list.push(Value::object().set("text", text).set("count", count));
  }
  return list;
}

Value to_value(const SewingAccount& sewing) {
  return Value::object()
      .set("done", sewing.done)
      .set("declined", sewing.declined)
      .set("tolerance", sewing.tolerance)
      .set("faces", sewing.faces)
      .set("shells", sewing.shells)
      .set("solids", sewing.solids)
      .set("free_edges_before", sewing.free_edges_before)
      .set("free_edges_after", sewing.free_edges_after)
      .set("dropped_faces", sewing.dropped)
      .set("turned_faces", sewing.turned);
}

void print_list(const Common& common, const char* what, const std::vector<std::string>& texts) {
  for (size_t k = 0; k < texts.size() && k < kListed; ++k) {
    print(common, format("  %s %s", what, texts[k].c_str()));
  }
  if (texts.size() > kListed) {
    print(common, format("  %s %zu more", what, texts.size() - kListed));
  }
}

void print_counts(const Common& common, const char* what,
                  const std::vector<std::pair<std::string, int>>& counts) {
  std::vector<std::string> texts;
  for (const auto& [text, count] : counts) texts.push_back(format("%s (%d)", text.c_str(), count));
  print_list(common, what, texts);
}

}  // namespace

Value to_value(const ImportAccount& account) {
  return Value::object()
      .set("complete", account.complete())
      .set("entities", account.entities)
      .set("error_entities", account.error_entities)
      .set("roots", account.roots)
      .set("junk_bytes", account.junk_bytes)
      .set("stated", account.has_text ? to_value(account.stated) : Value())
      .set("read", to_value(account.read))
      .set("lost_faces", account.lost)
      .set("added_faces", account.added_faces)
      .set("unused_faces", account.unused)
      .set("faces_without_area", account.no_area)
      .set("broken_rules", account.broken)
      .set("repairs", to_value(account.repairs))
      .set("failures", to_value(account.failures))
      .set("sewing", to_value(account.sewing));
}

void print_import(const Common& common, const ImportAccount& account) {
  if (account.has_text) {
    print(common, format("import: %d of %d stated faces read, %d of %d shells, %d of %d solids",
                         account.stated.faces - static_cast<int>(account.lost.size()),
                         account.stated.faces, account.read.shells, account.stated.shells,
                         account.read.solids, account.stated.solids));
  }
  if (account.junk_bytes > 0) {
    print(common, format("  %d bytes before the header were skipped", account.junk_bytes));
  }
  print_list(common, "lost:", account.lost);
  print_list(common, "breaks the rules:", account.broken);
  print_list(common, "used by no shape:", account.unused);
  print_list(common, "without area:", account.no_area);
  if (account.added_faces > 0) {
    print(common, format("  made by the reader: %d faces that the file does not state",
                         account.added_faces));
  }
  print_counts(common, "could not be read:", account.failures);
  print_counts(common, "repaired while reading:", account.repairs);
  for (const std::string& line : account.sewing.lines()) print(common, "  " + line);
}

std::vector<std::string> import_findings(const ImportAccount& account) {
  std::vector<std::string> findings;
  for (const std::string& face : account.lost) findings.push_back("face lost on import: " + face);
  for (const std::string& text : account.broken) {
    findings.push_back("breaks the rules of STEP: " + text);
  }
  return findings;
}

}  // namespace isochor::app
