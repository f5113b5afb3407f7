#include "tools/forward/settings/forward_keys.hpp"

#include "config/document/limits.hpp"
#include "config/document/scalars.hpp"
#include "config/sections/store.hpp"
#include "tools/forward/settings/command_keys.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::Rows;

constexpr std::pair<std::string_view, PayloadFormat> kFormats[] = {
    {"protobuf", PayloadFormat::kProtobuf}, {"json", PayloadFormat::kJson}};
constexpr std::pair<std::string_view, bool> kCompressions[] = {{"none", false}, {"zstd", true}};

constexpr std::pair<std::string_view, std::int64_t> kRateUnits[] = {{"kB/s", 1'000},
                                                                    {"MB/s", 1'000'000}};
constexpr config::SizeRule kRate{.min = 1'000,
                                 .max = 1'000'000'000,
                                 .range = "1kB/s to 1000MB/s",
                                 .allowed = "1kB/s to 1000MB/s, with kB/s or MB/s",
                                 .pattern = R"([0-9]+(\\.[0-9]+)?(kB|MB)/s)",
                                 .units = kRateUnits,
                                 .fractions = true,
                                 .outside = "is too small or too large"};

constexpr std::pair<std::string_view, std::int64_t> kSizeUnits[] = {
    {"MB", 1'000'000}, {"GB", 1'000'000'000}, {"TB", 1'000'000'000'000}};
constexpr config::SizeRule kSize{.min = 1'000'000,
                                 .max = 10'000'000'000'000,
                                 .range = "1MB to 10TB",
                                 .allowed = "1MB to 10TB, with MB, GB or TB",
                                 .pattern = "[0-9]+(MB|GB|TB)",
                                 .units = kSizeUnits};

constexpr Duration kMostGather = std::chrono::minutes{1};
constexpr Duration kLeastGather = std::chrono::milliseconds{10};
constexpr Duration kLeastLate = std::chrono::seconds{1};
constexpr Duration kMostLate = std::chrono::hours{24};

}  // namespace

const Rows<ForwardSpec>& forward_rows() {
  static const Rows<ForwardSpec> rows(
      "forward", "the configuration",
      {
          field<ForwardSpec>({.name = "site",
                              .fallback = std::string(config::kNeeded),
                              .text = "the name of this site in subjects and message ids; unique "
                                      "among all sites of the engine",
                              .example = "site: NAME"},
                             &ForwardSpec::site, config::NameRule{}),
          {{.name = "dds", .text = "as of the bridge: `domain`, `interfaces`, ..", .schema = "{}"}},
          {{.name = "log", .text = "as of the bridge: `level`", .schema = "{}"}},
          {{.name = "commands",
            .text = "who may write from the centre; without it, nobody",
            .schema = "{}"}},
          {{.name = "metrics",
            .text = "`listen: ADDRESS:PORT` for Prometheus; as of the bridge",
            .schema = "{}"}},
          {{.name = "queue",
            .fallback = std::string(config::kNeeded),
            .text = "the file with what is not acknowledged yet",
            .schema = "{}"}},
          {{.name = "gather", .text = "when a message is full", .schema = "{}"}},
          {{.name = "payload", .text = "the form of the messages", .schema = "{}"}},
          {{.name = "send", .text = "in which order and how fast", .schema = "{}"}},
          {{.name = "jetstream", .text = "the engine: servers of NATS JetStream", .schema = "{}"}},
          {{.name = "postgresql", .text = "the engine: PostgreSQL or TimescaleDB", .schema = "{}"}},
      });
  return rows;
}

const Rows<QueueSpec>& queue_rows() {
  static const Rows<QueueSpec> rows(
      "queue", "'queue'",
      {
          field<QueueSpec>({.name = "path",
                            .fallback = std::string(config::kNeeded),
                            .text = "a file on a local disk, relative to this file; its owner is "
                                    "the user of the program",
                            .example = "path: FILE"},
                           &QueueSpec::path, config::TextRule{config::kMaxPath}),
          field<QueueSpec>({.name = "max-size",
                            .fallback = "`1GB`",
                            .text = "of all waiting records; then samples are thinned out and "
                                    "removed, see below"},
                           &QueueSpec::max_bytes, kSize),
          field<QueueSpec>({.name = "keep",
                            .fallback = "`forever`",
                            .text = "older records are removed, also without an acknowledgement"},
                           &QueueSpec::keep, config::KeepRule{}),
      });
  return rows;
}

const Rows<GatherSpec>& gather_rows() {
  static const Rows<GatherSpec> rows(
      "gather", "'gather'",
      {
          field<GatherSpec>({.name = "time",
                             .fallback = "`1s`",
                             .text = "from the first sample of a message until it is queued; a "
                                     "longer time needs fewer bytes for each sample"},
                            &GatherSpec::time, config::DurationRule{kLeastGather, kMostGather}),
          field<GatherSpec>({.name = "samples",
                             .fallback = "`1000`",
                             .text = "of one message; then it is queued immediately"},
                            &GatherSpec::samples, config::WholeRule{1, 2'000}),
      });
  return rows;
}

const Rows<PayloadSpec>& payload_rows() {
  static const Rows<PayloadSpec> rows(
      "payload", "'payload'",
      {
          field<PayloadSpec>({.name = "format",
                              .fallback = "`protobuf`",
                              .text = "of all messages and of the catalogue"},
                             &PayloadSpec::format, config::ChoiceRule<PayloadFormat>{kFormats}),
          field<PayloadSpec>(
              {.name = "compress", .fallback = "`none`", .text = "of messages with samples"},
              &PayloadSpec::compress, config::ChoiceRule<bool>{kCompressions}),
      });
  return rows;
}

const Rows<SendSpec>& send_rows() {
  static const Rows<SendSpec> rows(
      "send", "'send'",
      {
          field<SendSpec>({.name = "in-flight",
                           .fallback = "`256`",
                           .text = "messages that wait for an acknowledgement; one of each device"},
                          &SendSpec::in_flight, config::WholeRule{1, 4'096}),
          field<SendSpec>({.name = "max-rate",
                           .fallback = "no limit",
                           .text = "of the messages, without TLS and TCP"},
                          &SendSpec::max_rate, kRate),
          field<SendSpec>({.name = "late-after",
                           .fallback = "`10s`",
                           .text = "samples that are older when they can be sent are late: newer "
                                   "ones are sent first"},
                          &SendSpec::late_after, config::DurationRule{kLeastLate, kMostLate}),
      });
  return rows;
}

std::vector<DocumentedKey> documented_keys() {
  std::vector<DocumentedKey> all;
  const AddKeys add = [&all](const std::string& prefix, const config::RowTable& table) {
    for (const config::Key& row : table.rows)
      all.push_back({prefix + std::string(row.name), row.fallback, row.form, row.text});
  };
  add("", forward_rows());
  add("queue.", queue_rows());
  add("gather.", gather_rows());
  add("payload.", payload_rows());
  add("send.", send_rows());
  for (const OutletSection& section : outlet_sections()) section.document(add);
  document_commands(add);
  return all;
}

}  // namespace fieldcast::forward
