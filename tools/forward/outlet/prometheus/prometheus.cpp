#include "tools/forward/outlet/prometheus/prometheus.hpp"

#include <utility>

#include "tools/forward/outlet/http/http_outlet.hpp"
#include "tools/forward/outlet/prometheus/remote_write.hpp"

namespace fieldcast::forward {

std::unique_ptr<Outlet> make_prometheus(const PrometheusSpec& spec, OutletContext context) {
  HttpEngine engine;
  engine.subject = "prometheus";
  engine.headers = {"Content-Type: application/x-protobuf", "Content-Encoding: snappy",
                    "X-Prometheus-Remote-Write-Version: 0.1.0"};
  engine.refusal = "too old sample";  // with status 500 by Prometheus 2.42
  // The decoder and the encoder are shared by the copies of std::function.
  engine.encode = [encoder = std::make_shared<WriteRequestEncoder>(context.site),
                   decoder = std::make_shared<RecordDecoder>(context.catalogue)](
                      const Record& record) -> std::optional<std::string> {
    if (record.kind != RecordKind::kSamples) return std::string();  // has no place
    const auto samples = decoder->samples(record);
    if (!samples) return std::nullopt;
    return encoder->encode(samples->batch, *samples->catalogue);
  };
  engine.compress = snappy_block;
  return std::make_unique<HttpOutlet>(spec.http, std::move(engine), std::move(context.wake));
}

}  // namespace fieldcast::forward
