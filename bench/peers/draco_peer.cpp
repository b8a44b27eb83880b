// SPDX-License-Identifier: BSD-3-Clause
// Draco's kd-tree point cloud coder at its best ratio.
#include <draco/compression/decode.h>
#include <draco/compression/encode.h>
#include <draco/point_cloud/point_cloud_builder.h>

#include <array>

#include "peers.hpp"

namespace curlidar::bench {
namespace {

std::unique_ptr<draco::PointCloud> draco_cloud(const std::vector<Vec3>& points) {
  draco::PointCloudBuilder builder;
  builder.Start(static_cast<draco::PointIndex::ValueType>(points.size()));
  const int id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::array<float, 3> p = {static_cast<float>(points[i].x),
                                    static_cast<float>(points[i].y),
                                    static_cast<float>(points[i].z)};
    builder.SetAttributeValueForPoint(
        id, draco::PointIndex(static_cast<draco::PointIndex::ValueType>(i)), p.data());
  }
  return builder.Finalize(false);
}

Result<Decoded> run(const Grid& grid, double bits) {
  draco::Encoder encoder;
  encoder.SetSpeedOptions(0, 0);
  encoder.SetEncodingMethod(draco::POINT_CLOUD_KD_TREE_ENCODING);
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, static_cast<int>(bits));
  draco::EncoderBuffer packed;
  const auto cloud = draco_cloud(grid.returns.positions);
  Decoded result;
  CpuTimer timer;
  const draco::Status status = encoder.EncodePointCloudToBuffer(*cloud, &packed);
  if (!status.ok()) return Error{ErrorCode::corrupt, status.error_msg_string()};
  result.encode_ms = timer.lap_ms();

  draco::DecoderBuffer source;
  source.Init(packed.data(), packed.size());
  draco::Decoder decoder;
  auto decoded = decoder.DecodePointCloudFromBuffer(&source);
  if (!decoded.ok()) return Error{ErrorCode::corrupt, decoded.status().error_msg_string()};
  result.decode_ms = timer.lap_ms();
  const draco::PointCloud& out = *decoded.value();
  const auto* positions = out.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  result.bytes = packed.size();
  for (draco::PointIndex i(0); i < out.num_points(); ++i) {
    std::array<float, 3> p{};
    positions->GetMappedValue(i, p.data());
    result.cloud.positions.push_back({p[0], p[1], p[2]});
  }
  return result;
}

}  // namespace

Peer draco_peer() {
  return {"draco-kd-tree", "bits", {7, 8, 9, 10, 11, 12, 13, 14, 15}, run};
}

}  // namespace curlidar::bench
