#include "tools/forward/settings/prometheus_keys.hpp"

#include "tools/forward/settings/http_keys.hpp"

namespace fieldcast::forward {
namespace {

const config::Rows<PrometheusSpec>& prometheus_rows() {
  static const config::Rows<PrometheusSpec> rows(
      "prometheus", "'prometheus'",
      http_fields<PrometheusSpec>("http://127.0.0.1:9090/api/v1/write"));
  return rows;
}

}  // namespace

OutletSpec read_prometheus(config::MapReader& file, const config::Node& section,
                           config::Library& library) {
  PrometheusSpec spec;
  config::MapReader map(section, prometheus_rows(), file.faults());
  prometheus_rows().read(map, spec);
  read_http(map, library, spec.http);
  return spec;
}

void document_prometheus(const AddKeys& add) { add("prometheus.", prometheus_rows()); }

}  // namespace fieldcast::forward
