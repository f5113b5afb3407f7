#include "tools/forward/settings/influxdb_keys.hpp"

#include "tools/forward/settings/http_keys.hpp"
#include "tools/forward/settings/login_keys.hpp"

namespace fieldcast::forward {
namespace {

using config::field;
using config::MapReader;
using config::Node;
using config::Rows;

std::vector<config::Field<InfluxdbSpec>> influxdb_fields() {
  auto fields = http_fields<InfluxdbSpec>("http://127.0.0.1:8086");
  for (auto& one : {field<InfluxdbSpec>({.name = "database",
                   .fallback = "`fieldcast`",
                   .text = "of InfluxDB 1 and VictoriaMetrics"},
                                        &InfluxdbSpec::database, config::TextRule{256}),
                    field<InfluxdbSpec>({.name = "organization",
                    .fallback = "none",
                    .text = "of InfluxDB 2, with `bucket` and `token-file`"},
                                        &InfluxdbSpec::organization, config::TextRule{256}),
                    field<InfluxdbSpec>({.name = "bucket",
                    .fallback = "none",
                    .text = "of InfluxDB 2, instead of the database"},
                                        &InfluxdbSpec::bucket, config::TextRule{256}),
                    field<InfluxdbSpec>({.name = "create",
                    .fallback = "`false`",
                    .text = "creates the database of InfluxDB 1 if it is missing; the "
                            "user must be an administrator"},
                                        &InfluxdbSpec::create, config::FlagRule{})})
    fields.push_back(one);
  return fields;
}

const Rows<InfluxdbSpec>& influxdb_rows() {
  static const Rows<InfluxdbSpec> rows("influxdb", "'influxdb'", influxdb_fields());
  return rows;
}

}  // namespace

OutletSpec read_influxdb(MapReader& file, const Node& section, config::Library& library) {
  InfluxdbSpec spec;
  MapReader map(section, influxdb_rows(), file.faults());
  influxdb_rows().read(map, spec);
  read_http(map, library, spec.http);
  check_pair(map, "organization", spec.organization, "bucket", spec.bucket, "both");
  return spec;
}

void document_influxdb(const AddKeys& add) { add("influxdb.", influxdb_rows()); }

}  // namespace fieldcast::forward
