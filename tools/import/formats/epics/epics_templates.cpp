// Source: epics-modules/modbus modbusApp/Db.

#include <algorithm>

#include "tools/import/formats/epics/epics_files.hpp"

namespace fieldcast::importing {

namespace {

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

}  // namespace

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

}  // namespace fieldcast::importing
