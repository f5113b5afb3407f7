#include "tools/forward/outlet/influxdb/influxdb.hpp"

#include <fmt/format.h>

#include <utility>

#include "bridge/log/log.hpp"
#include "tools/forward/outlet/http/http_outlet.hpp"
#include "tools/forward/outlet/influxdb/gzip.hpp"
#include "tools/forward/outlet/influxdb/line_protocol.hpp"
#include "tools/forward/outlet/percent_encoded.hpp"
#include "tools/forward/payload/codec.hpp"

namespace fieldcast::forward {

namespace {

class LineEncoder {
 public:
  LineEncoder(std::string site, RecordDecoder::FindCatalogue catalogue)
      : site_(std::move(site)), decoder_(std::move(catalogue)) {}

  std::optional<std::string> operator()(const Record& record) {
    switch (record.kind) {
      case RecordKind::kCatalogue:
      case RecordKind::kAudit: return std::string();
      case RecordKind::kAlarm:
        if (const auto alarm = decode_alarm(record.body)) return to_line(site_, *alarm);
        return std::nullopt;
      case RecordKind::kSamples: break;
    }
    const auto samples = decoder_.samples(record);
    if (!samples) return std::nullopt;
    return to_lines(site_, samples->batch, *samples->catalogue);
  }

 private:
  std::string site_;
  RecordDecoder decoder_;
};

std::string path_of(const InfluxdbSpec& spec) {
  if (spec.bucket.empty()) return "/write?precision=ns&db=" + percent_encoded(spec.database);
  return fmt::format("/api/v2/write?precision=ns&org={}&bucket={}",
                     percent_encoded(spec.organization), percent_encoded(spec.bucket));
}

}  // namespace

std::unique_ptr<Outlet> make_influxdb(const InfluxdbSpec& spec, OutletContext context) {
  const bool has_bucket = !spec.bucket.empty();
  if (has_bucket && (spec.create || spec.database != InfluxdbSpec{}.database))
    log_warning("influxdb",
                "'database' and 'create' have no effect beside 'bucket'; remove them, or remove "
                "'bucket' and 'organization' to write to the database");
  HttpEngine engine;
  engine.subject = "influxdb";
  engine.path = path_of(spec);
  engine.headers = {"Content-Type: text/plain; charset=utf-8", "Content-Encoding: gzip"};
  engine.token_scheme = "Token";
  // A function object with state, shared by the copies of std::function.
  engine.encode = [encoder = std::make_shared<LineEncoder>(context.site, context.catalogue)](
                      const Record& record) { return (*encoder)(record); };
  engine.compress = gzipped;
  engine.empty_refusal = "writing requires points";  // InfluxDB 2.0 up to 2.0.8
  if (spec.create && !has_bucket)
    engine.create_path =
        "/query?q=" + percent_encoded(fmt::format("CREATE DATABASE \"{}\"", spec.database));
  return std::make_unique<HttpOutlet>(spec.http, std::move(engine), std::move(context.wake));
}

}  // namespace fieldcast::forward
