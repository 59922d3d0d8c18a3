/* SPDX-FileCopyrightText: 2026 The CoSLAM authors
 * SPDX-License-Identifier: Apache-2.0
 *
 * cyclone_camera KEY=VALUE...: a camera's node made with Cyclone DDS and the code that it generates. It publishes on one
 * topic until it is ended:
 *
 *   domain=N topic=/NAME       of ROS 2
 *   type=image|file|info|points   sensor_msgs Image, CompressedImage of the octets of a file, CameraInfo, PointCloud2
 *   width=W height=H step=S encoding=E   of images and CameraInfo; step is that of images, W by default
 *   file=PATH format=TEXT      of a CompressedImage
 *   rate=HZ first=N count=N    the number of the first message and how many there are; 0: no end
 *   reliable=0|1 exclusive=0|1 QoS
 *   stamped=0|1                0: stamps are 0
 *
 * Message n has the stamp 1700000000 + n / 1000 seconds and n % 1000 milliseconds and 7 ns; octet i of its image is
 * (7 i + i / 256 + 31 (n % 8)) % 256.
 */
#include <dds/dds.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "ros2.h"

enum { kKinds = 8, kFirstSecond = 1700000000, kOddNanoseconds = 7 };

static const char *text_of(int argc, char **argv, const char *key, const char *otherwise) {
  const size_t length = strlen(key);
  for (int i = 1; i < argc; ++i) {
    if (strncmp(argv[i], key, length) == 0 && argv[i][length] == '=') return argv[i] + length + 1;
  }
  return otherwise;
}

static long number_of(int argc, char **argv, const char *key, long otherwise) {
  const char *text = text_of(argc, argv, key, NULL);
  return text == NULL ? otherwise : atol(text);
}

static dds_entity_t made(dds_entity_t entity, const char *what) {
  if (entity >= 0) return entity;
  fprintf(stderr, "cyclone_camera: %s: %s\n", what, dds_strretcode(entity));
  exit(1);
}

static dds_entity_t writer_of(int argc, char **argv, const dds_topic_descriptor_t *type) {
  char name[256];
  dds_qos_t *qos = dds_create_qos();
  const int reliable = (int)number_of(argc, argv, "reliable", 1);
  const dds_domainid_t domain = (dds_domainid_t)number_of(argc, argv, "domain", 0);
  const dds_entity_t participant = made(dds_create_participant(domain, NULL, NULL), "participant");
  snprintf(name, sizeof name, "rt%s", text_of(argc, argv, "topic", "/image"));
  const dds_entity_t topic = made(dds_create_topic(participant, type, name, NULL, NULL), "topic");
  dds_qset_reliability(qos, reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, DDS_SECS(1));
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, 5);
  if (number_of(argc, argv, "exclusive", 0)) dds_qset_ownership(qos, DDS_OWNERSHIP_EXCLUSIVE);
  const dds_entity_t writer = made(dds_create_writer(participant, topic, qos, NULL), "writer");
  dds_delete_qos(qos);
  return writer;
}

static std_msgs_msg_dds__Header_ header_of(long n, int stamped) {
  std_msgs_msg_dds__Header_ header = {{0, 0}, "camera"};
  if (stamped) {
    header.stamp.sec = (int32_t)(kFirstSecond + n / 1000);
    header.stamp.nanosec = (uint32_t)(n % 1000 * 1000000 + kOddNanoseconds);
  }
  return header;
}

static dds_sequence_octet octets_of_file(const char *path) {
  dds_sequence_octet octets = {0, 0, NULL, false};
  FILE *file = fopen(path, "rb");
  if (file == NULL) exit(1);
  fseek(file, 0, SEEK_END);
  octets._length = octets._maximum = (uint32_t)ftell(file);
  rewind(file);
  octets._buffer = malloc(octets._length);
  if (fread(octets._buffer, 1, octets._length, file) != octets._length) exit(1);
  fclose(file);
  return octets;
}

static dds_sequence_octet octets_of_image(uint32_t size, int kind) {
  dds_sequence_octet octets = {size, size, malloc(size), false};
  for (uint32_t i = 0; i < size; ++i) octets._buffer[i] = (uint8_t)(7 * i + i / 256 + 31 * (uint32_t)kind);
  return octets;
}

int main(int argc, char **argv) {
  const char *type = text_of(argc, argv, "type", "image");
  const uint32_t width = (uint32_t)number_of(argc, argv, "width", 64);
  const uint32_t height = (uint32_t)number_of(argc, argv, "height", 48);
  const uint32_t step = (uint32_t)number_of(argc, argv, "step", (long)width);
  const long first = number_of(argc, argv, "first", 0), count = number_of(argc, argv, "count", 0);
  const int stamped = (int)number_of(argc, argv, "stamped", 1);
  const dds_duration_t period = DDS_SECS(1) / number_of(argc, argv, "rate", 30);
  const int is_image = strcmp(type, "image") == 0, is_file = strcmp(type, "file") == 0;
  const int is_info = strcmp(type, "info") == 0;
  sensor_msgs_msg_dds__Image_ image = {0};
  sensor_msgs_msg_dds__CompressedImage_ compressed = {0};
  sensor_msgs_msg_dds__CameraInfo_ info = {0};
  sensor_msgs_msg_dds__PointCloud2_ points = {0};
  dds_sequence_octet kinds[kKinds];
  double d[5] = {-0.25, 0.125, 0.0078125, -0.00390625, 0.015625};

  const dds_entity_t writer = writer_of(argc, argv,
                                        is_image  ? &sensor_msgs_msg_dds__Image__desc
                                        : is_file ? &sensor_msgs_msg_dds__CompressedImage__desc
                                        : is_info ? &sensor_msgs_msg_dds__CameraInfo__desc
                                                  : &sensor_msgs_msg_dds__PointCloud2__desc);
  image.width = width;
  image.height = height;
  image.step = step;
  image.encoding = (char *)text_of(argc, argv, "encoding", "mono8");
  if (is_image) {
    for (int kind = 0; kind < kKinds; ++kind) kinds[kind] = octets_of_image(step * height, kind);
  }
  compressed.format = (char *)text_of(argc, argv, "format", "png");
  if (is_file) compressed.data = octets_of_file(text_of(argc, argv, "file", ""));
  info.width = width;
  info.height = height;
  info.distortion_model = "plumb_bob";
  info.d._length = info.d._maximum = 5;
  info.d._buffer = d;
  info.k[0] = 500.5;
  info.k[2] = 31.25;
  info.k[4] = 501.75;
  info.k[5] = 23.5;
  info.k[8] = 1;
  points.header.frame_id = "";

  dds_time_t next = dds_time();
  for (long n = first; count == 0 || n < first + count; ++n) {
    image.header = compressed.header = info.header = points.header = header_of(n, stamped);
    if (is_image) image.data = kinds[n % kKinds];
    dds_write(writer, is_image ? (void *)&image : is_file ? (void *)&compressed : is_info ? (void *)&info : &points);
    next += period;
    if (next > dds_time()) dds_sleepfor(next - dds_time());
  }
  for (;;) dds_sleepfor(DDS_SECS(1)); /* it still sends again what was lost */
}
