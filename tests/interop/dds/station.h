/* What a station in C on Cyclone DDS needs besides the types that idlc makes of fieldcast.idl: the
 * QoS of the topics, written as text. One thread. A failure ends the program with its reason: these
 * are examples, and peers for tests. */
#pragma once

#include <stdbool.h>

#include "dds/dds.h"
#include "fieldcast.h"

/* The entity, or the end of the program when it is an error. */
dds_entity_t need(dds_entity_t entity, const char* what);

/* Reliable, transient-local, keep last 1: Sample, Channel, BusStatus, DeviceStatus. A deadline
 * above 0 matches just the writers that promise it or better. The caller deletes it with
 * dds_delete_qos. */
dds_qos_t* state_qos(dds_duration_t deadline);

/* Reliable, volatile, keep all: Command and CommandResult. */
dds_qos_t* request_qos(void);

/* Waits until both ends know each other. Results are volatile: who asks before the bridge has found
 * his reader may miss the answer. */
bool matched(dds_entity_t writer, dds_entity_t reader, dds_time_t until);

const char* quality_name(fieldcast_Quality quality);
const char* state_name(fieldcast_CommandState state);
const char* kind_name(fieldcast_ValueKind kind);
void print_value(const fieldcast_Value* value);

/* True once SIGTERM or SIGINT came; the first call listens for them. */
bool stopped(void);
