// Source of the templates: epics-modules/modbus modbusApp/Db.
#include "tools/import/formats/epics/epics_files.hpp"

#include <algorithm>
#include <charconv>
#include <set>

namespace fieldcast::importing {
namespace {

constexpr unsigned kMaxMacroDepth = 10;
constexpr unsigned kMaxMacroSteps = 10'000;      // in one text
constexpr std::size_t kMaxScanned = 256u << 20;  // bytes of databases; each load counts

std::string expand_at(std::string_view text, const Macros& macros, unsigned depth,
                      unsigned& steps) {
  std::string result;
  for (std::size_t i = 0; i < text.size() && result.size() < kMaxExpanded; ++i) {
    const bool begins =
        text[i] == '$' && i + 1 < text.size() && (text[i + 1] == '(' || text[i + 1] == '{');
    if (!begins) {
      result += text[i];
      continue;
    }
    if (++steps > kMaxMacroSteps) break;
    const char open = text[i + 1], close = open == '(' ? ')' : '}';
    std::size_t end = i + 2;
    for (unsigned inner = 1; end < text.size(); ++end) {
      if (text[end] == open) ++inner;
      if (text[end] == close && --inner == 0) break;
    }
    const std::string_view body = text.substr(i + 2, end - i - 2);
    const auto [name, usual] = halves(body, '=');
    const auto known = macros.find(trimmed(name));
    const bool has_usual = name.size() < body.size();
    if (depth < kMaxMacroDepth && (known != macros.end() || has_usual)) {
      result += expand_at(known != macros.end() ? known->second : usual, macros, depth + 1, steps);
    } else {
      result += text.substr(i, end - i + 1);
    }
    i = end;
  }
  return result;
}

std::string_view base_of(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? path : path.substr(slash + 1);
}

// Tokens of databases and substitutions: names, quoted texts, brackets, commas.
struct EpicsToken {
  std::string text;
  unsigned line = 0;    // from 1
  bool quoted = false;  // never a bracket
  [[nodiscard]] bool is(std::string_view mark) const { return !quoted && text == mark; }
};

class EpicsTokens {
 public:
  explicit EpicsTokens(std::string_view text) : text_(text) {}
  [[nodiscard]] std::optional<EpicsToken> next();

 private:
  void skip_blanks();
  std::string_view text_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
};

void EpicsTokens::skip_blanks() {
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    if (c == '#') at_ = std::min(text_.find('\n', at_), text_.size() - 1);
    if (text_[at_] == '\n') {
      ++line_;
    } else if (text_[at_] != ' ' && text_[at_] != '\t' && c != '#') {
      return;
    }
  }
}

std::optional<EpicsToken> EpicsTokens::next() {
  skip_blanks();
  if (at_ >= text_.size()) return std::nullopt;
  EpicsToken token{.text = {}, .line = line_};
  if (contains("{}(),", text_.substr(at_, 1))) {
    token.text = text_[at_++];
    return token;
  }
  if (text_[at_] == '"') {
    token.quoted = true;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      if (text_[at_] == '\n') ++line_;
      token.text += text_[at_];
    }
    if (at_ < text_.size()) ++at_;
    return token;
  }
  // The brackets of a macro are part of the word: $(P)$(R).
  std::size_t open = 0;
  for (; at_ < text_.size(); ++at_) {
    const char c = text_[at_];
    const bool macro = (c == '(' || c == '{') && at_ > 0 && text_[at_ - 1] == '$';
    if (macro) {
      ++open;
    } else if (open > 0 && (c == ')' || c == '}')) {
      --open;
    } else if (c == '\n' || (open == 0 && contains(" \t\"{}(),#", text_.substr(at_, 1)))) {
      break;
    }
    token.text += c;
  }
  return token;
}

struct ModuleTemplate {
  std::string_view file, record, interface, link;
};
constexpr std::string_view kTyped = "@asyn($(PORT) $(OFFSET))$(DATA_TYPE)";
constexpr std::string_view kMasked = "@asynMask($(PORT) $(OFFSET) $(MASK))";
constexpr std::string_view kOneBit = "@asynMask($(PORT) $(OFFSET) 0x1)";
constexpr std::string_view kAllBits = "@asynMask($(PORT) $(OFFSET) 0xFFFF)";
constexpr std::string_view kAnalog = "@asynMask($(PORT) $(OFFSET) $(BITS))MODBUS_DATA";

constexpr ModuleTemplate kTemplates[] = {
    {"ai", "ai", "asynInt32", kAnalog},
    {"ai_average", "ai", "asynInt32", kAnalog},
    {"ao", "ao", "asynInt32", kAnalog},
    {"aiFloat64", "ai", "asynFloat64", kTyped},
    {"aoFloat64", "ao", "asynFloat64", kTyped},
    {"bi_bit", "bi", "asynUInt32Digital", kOneBit},
    {"bo_bit", "bo", "asynUInt32Digital", kOneBit},
    {"bi_word", "bi", "asynUInt32Digital", kMasked},
    {"bo_word", "bo", "asynUInt32Digital", kMasked},
    {"mbbiDirect", "mbbiDirect", "asynUInt32Digital", kMasked},
    {"mbboDirect", "mbboDirect", "asynUInt32Digital", kMasked},
    {"longin", "longin", "asynUInt32Digital", kAllBits},
    {"longout", "longout", "asynUInt32Digital", kAllBits},
    {"longinInt32", "longin", "asynInt32", kTyped},
    {"longoutInt32", "longout", "asynInt32", kTyped},
    {"int64in", "int64in", "asynInt64", kTyped},
    {"int64out", "int64out", "asynInt64", kTyped},
    {"stringin", "stringin", "asynOctetRead", kTyped},
    {"stringout", "stringout", "asynOctetWrite", kTyped},
    {"stringWaveformIn", "waveform", "asynOctetRead", kTyped},
    {"stringWaveformOut", "waveform", "asynOctetWrite", kTyped},
    {"intarray_in", "waveform", "asynInt32ArrayIn", "@asyn($(PORT) $(OFFSET=0))MODBUS_DATA"},
    {"intarray_out", "waveform", "asynInt32ArrayOut", "@asyn($(PORT) $(OFFSET=0))MODBUS_DATA"},
    {"floatarray_in", "waveform", "asynFloat64ArrayIn", kTyped},
    {"floatarray_out", "waveform", "asynFloat64ArrayOut", kTyped},
};
constexpr std::string_view kOfTheDriver = "asynRecord statistics poll_delay poll_trigger";

std::string_view without_end(std::string_view file) { return file.substr(0, file.rfind('.')); }

// Record templates of the EPICS modbus module, which users need not pass; macros are unexpanded.
std::optional<EpicsRecord> module_template(std::string_view file) {
  const auto found = std::ranges::find(kTemplates, without_end(file), &ModuleTemplate::file);
  if (found == std::end(kTemplates)) return std::nullopt;
  EpicsRecord record;
  record.type = found->record;
  record.name = "$(P)$(R)";
  record.fields["DTYP"] = found->interface;
  const bool out = found->record == "ao" || found->record == "bo" ||
                   found->record.ends_with("out") || found->record == "mbboDirect";
  record.fields[out ? "OUT" : "INP"] = found->link;
  record.fields["SCAN"] = "$(SCAN=I/O Intr)";
  record.fields["NELM"] = "$(NELM=1)";
  if (found->interface == "asynInt32" && found->link == kAnalog) {
    record.fields["LINR"] = "LINEAR";
    record.fields["EGUL"] = "$(EGUL=0)";
    record.fields["EGUF"] = "$(EGUF=0)";
  }
  return record;
}

bool is_driver_template(std::string_view file) {
  return is_one_of(without_end(file), kOfTheDriver);
}

class EpicsLoader {
 public:
  explicit EpicsLoader(std::span<const SourceText> sources) : sources_(sources) {}

  EpicsFiles load() {
    for (const SourceText& source : sources_) {
      if (is_startup_script(source.text)) load_script(source);
    }
    for (const SourceText& source : sources_) {
      if (!used_.contains(source.file) && is_substitutions(source.text))
        load_substitutions(source, {});
    }
    for (const SourceText& source : sources_) {
      if (!used_.contains(source.file) && is_database(source.text)) load_database(source, {});
    }
    return std::move(files_);
  }

 private:
  void load_script(const SourceText& source) {
    used_.insert(source.file);
    files_.has_script = true;
    unsigned line = 0;
    for (std::string_view rest = source.text; !rest.empty();) {
      const auto [first, others] = halves(rest, '\n');
      rest = others;
      ++line;
      const std::string text = expand(trimmed(first), environment_);
      if (text.empty() || text[0] == '#' || text[0] == '<') continue;
      IocCall call = call_of(text);
      call.origin = {source.file, line};
      obey(call);
      files_.calls.push_back(std::move(call));
    }
  }

  // "command(a, "b c", 3)" or "command a "b c" 3".
  static IocCall call_of(std::string_view text) {
    IocCall call;
    std::size_t at = std::min(text.find_first_of(" \t(,"), text.size());
    call.command = text.substr(0, at);
    while (at < text.size()) {
      at = text.find_first_not_of(" \t(),", at);
      if (at == std::string_view::npos || text[at] == '#') break;
      std::string argument;
      if (text[at] == '"') {
        for (++at; at < text.size() && text[at] != '"'; ++at) {
          if (text[at] == '\\' && at + 1 < text.size()) ++at;
          argument += text[at];
        }
        if (at < text.size()) ++at;
      } else {
        const std::size_t end = std::min(text.find_first_of(" \t),", at), text.size());
        argument = text.substr(at, end - at);
        at = end;
      }
      call.arguments.push_back(std::move(argument));
    }
    return call;
  }

  void obey(const IocCall& call) {
    const std::string_view path = call.argument(0);
    if (call.command == "epicsEnvSet") environment_[std::string(path)] = call.argument(1);
    const bool substitutions = call.command == "dbLoadTemplate";
    if (!substitutions && call.command != "dbLoadRecords") return;
    Macros macros = macros_from(call.argument(1));
    for (const auto& [name, value] : environment_) macros.try_emplace(name, value);
    const SourceText* source = given(path);
    if (source != nullptr && substitutions) {
      load_substitutions(*source, macros);
    } else if (source != nullptr) {
      load_database(*source, macros);
    } else if (substitutions) {
      missing(path, call.origin);
    } else {
      load_template(path, macros, call.origin);
    }
  }

  const SourceText* given(std::string_view path) {
    const auto found = std::ranges::find_if(
        sources_, [&](const SourceText& source) { return base_of(source.file) == base_of(path); });
    if (found == sources_.end()) return nullptr;
    used_.insert(found->file);
    return &*found;
  }

  void missing(std::string_view path, const Origin& origin) {
    files_.refusals.push_back(
        {std::string(path), origin, "the file is not among those that were given; give it, too"});
  }

  void load_template(std::string_view path, const Macros& macros, const Origin& origin) {
    if (const SourceText* source = given(path)) return load_database(*source, macros, &origin);
    const std::string_view base = base_of(path);
    if (is_driver_template(base)) {
      ++files_.driver_records;
    } else if (auto record = module_template(base)) {
      expand_record(*record, macros);
      record->origin = origin;
      keep(std::move(*record));
    } else {
      missing(path, origin);
    }
  }

  static void expand_record(EpicsRecord& record, const Macros& macros) {
    record.name = expand(record.name, macros);
    for (auto& [field, value] : record.fields) value = expand(value, macros);
  }

  void keep(EpicsRecord record) {
    if (files_.records.size() < kMaxRecords) files_.records.push_back(std::move(record));
  }

  // record(ai, "name") { field(DTYP, "..") .. }
  void load_database(const SourceText& source, const Macros& macros,
                     const Origin* named_at = nullptr) {
    scanned_ += source.text.size();
    if (scanned_ > kMaxScanned || files_.records.size() == kMaxRecords) return;
    EpicsTokens tokens(source.text);
    while (auto token = tokens.next()) {
      if (!token->is("record") && !token->is("grecord")) continue;
      EpicsRecord record;
      record.origin = named_at != nullptr ? *named_at : Origin{source.file, token->line};
      if (!read_head(tokens, record)) continue;
      if (!read_fields(tokens, record)) break;
      expand_record(record, macros);
      keep(std::move(record));
    }
  }

  static bool read_head(EpicsTokens& tokens, EpicsRecord& record) {
    std::vector<EpicsToken> head;
    for (auto token = tokens.next(); token && !token->is(")"); token = tokens.next()) {
      head.push_back(*token);
      if (head.size() > 4) return false;
    }
    if (head.size() != 4 || !head[0].is("(") || !head[2].is(",")) return false;
    record.type = head[1].text;
    record.name = head[3].text;
    return true;
  }

  static bool read_fields(EpicsTokens& tokens, EpicsRecord& record) {
    auto token = tokens.next();
    if (!token || !token->is("{")) return token.has_value();
    while ((token = tokens.next()) && !token->is("}")) {
      if (!token->is("field")) continue;
      const auto open = tokens.next(), name = tokens.next(), comma = tokens.next(),
                 value = tokens.next();
      if (!value || !open->is("(") || !comma->is(",")) return false;
      record.fields[name->text] = value->text;
    }
    return token.has_value();
  }

  // file "x.template" { pattern {A, B} {1, 2} .. } or { {A=1, B=2} .. }
  void load_substitutions(const SourceText& source, const Macros& outer) {
    used_.insert(source.file);
    EpicsTokens tokens(source.text);
    Macros global = outer;
    while (auto token = tokens.next()) {
      if (token->is("global")) {
        if (!tokens.next()) return;  // the bracket
        for (const auto& [name, value] : read_assignments(tokens)) global[name] = value;
        continue;
      }
      if (!token->is("file")) continue;
      const auto path = tokens.next();
      const auto open = tokens.next();
      if (!path || !open || !open->is("{")) return;
      read_rows(tokens, source, expand(path->text, outer), global);
    }
  }

  void read_rows(EpicsTokens& tokens, const SourceText& source, const std::string& path,
                 const Macros& global) {
    std::optional<std::vector<std::string>> pattern;
    while (auto token = tokens.next()) {
      if (token->is("}")) return;
      if (token->is("pattern")) {
        if (!tokens.next()) return;  // the bracket
        pattern = read_list(tokens);
        continue;
      }
      if (!token->is("{")) continue;
      Macros macros = global;
      if (pattern) {
        const auto values = read_list(tokens);
        for (std::size_t i = 0; i < std::min(values.size(), pattern->size()); ++i)
          macros[(*pattern)[i]] = values[i];
      } else {
        for (const auto& [name, value] : read_assignments(tokens)) macros[name] = value;
      }
      load_template(path, macros, {source.file, token->line});
    }
  }

  static std::vector<std::string> read_list(EpicsTokens& tokens) {
    std::vector<std::string> list;
    while (auto token = tokens.next()) {
      if (token->is("}")) break;
      if (!token->is(",")) list.push_back(token->text);
    }
    return list;
  }

  // A=1, B="x y": a quoted value is the next token after its name.
  static Macros read_assignments(EpicsTokens& tokens) {
    Macros macros;
    std::string name;
    while (auto token = tokens.next()) {
      if (token->is("}")) break;
      if (token->is(",")) continue;
      const std::size_t equals = token->quoted ? std::string::npos : token->text.find('=');
      if (equals != std::string::npos) {
        name = token->text.substr(0, equals);
        macros[name] = token->text.substr(equals + 1);
      } else if (!name.empty()) {
        macros[name] += token->text;
      }
    }
    return macros;
  }

  std::span<const SourceText> sources_;
  EpicsFiles files_;
  Macros environment_;
  std::set<std::string> used_;
  std::size_t scanned_ = 0;
};

}  // namespace

std::string expand(std::string_view text, const Macros& macros) {
  unsigned steps = 0;
  return expand_at(text, macros, 0, steps);
}

Macros macros_from(std::string_view text) {
  Macros macros;
  for (const std::string_view part : split(text, ',')) {
    const auto [name, value] = halves(part, '=');
    if (name.size() < part.size()) macros[std::string(trimmed(name))] = trimmed(value);
  }
  return macros;
}

EpicsFiles load_epics(std::span<const SourceText> sources) { return EpicsLoader(sources).load(); }

bool is_startup_script(std::string_view text) {
  return contains(text, "drvModbusAsynConfigure") || contains(text, "drvAsyn") ||
         contains(text, "dbLoadRecords") || contains(text, "dbLoadTemplate");
}

bool is_database(std::string_view text) {
  return (contains(text, "record(") || contains(text, "record (")) && contains(text, "field");
}

bool is_substitutions(std::string_view text) {
  const std::size_t file = text.find("file ");
  return file != std::string_view::npos && text.find('{', file) != std::string_view::npos &&
         (contains(text, "pattern") || contains(text, ".template") || contains(text, ".db"));
}

std::optional<std::int64_t> c_number(std::string_view text, std::int64_t least, std::int64_t most) {
  text = trimmed(text);
  const bool minus = text.starts_with('-');
  if (minus) text.remove_prefix(1);
  int base = 10;
  if (text.starts_with("0x") || text.starts_with("0X")) {
    base = 16;
    text.remove_prefix(2);
  } else if (text.size() > 1 && text[0] == '0') {
    base = 8;
  }
  std::int64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  if (fault != std::errc{} || text.empty() || end != text.data() + text.size()) return std::nullopt;
  if (minus) number = -number;
  return number >= least && number <= most ? std::optional(number) : std::nullopt;
}

}  // namespace fieldcast::importing
