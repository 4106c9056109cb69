#pragma once

/// The names of the channels (docs/messages.md). A bus may put a prefix before them.
namespace eg::messages::channels {

inline constexpr char kRgbd[] = "RGBD";                    ///< frame_source → feature_extractor, mapper; stream
inline constexpr char kFeatures[] = "FEATURES";            ///< feature_extractor → tracker; stream
inline constexpr char kPose[] = "POSE";                    ///< tracker → mapper, viewers, robots; stream
inline constexpr char kKeyframe[] = "KEYFRAME";            ///< tracker → egraph_server, mapper; state
inline constexpr char kGraphUpdate[] = "EGRAPH_UPDATE";    ///< egraph_server → tracker, viewers; state
inline constexpr char kGraphRequest[] = "EGRAPH_REQUEST";  ///< anyone → egraph_server: what am I lacking?
inline constexpr char kGraphSnapshot[] = "EGRAPH";         ///< egraph_server → whoever asked: a snapshot, in parts
inline constexpr char kRestoreRequest[] = "EGRAPH_RESTORE_REQUEST";  ///< egraph_server → tracker: I lack keyframes
inline constexpr char kRestore[] = "EGRAPH_RESTORE";                 ///< tracker → egraph_server: its replica
inline constexpr char kPoseCorrection[] = "POSE_CORRECTION";         ///< tracker → mapper, viewers; state
inline constexpr char kKeyframeFeatures[] = "KEYFRAME_FEATURES";     ///< tracker → whoever asked; FEATURES of old
inline constexpr char kMeshChunk[] = "MESH_CHUNK";                   ///< mapper → viewers; state
inline constexpr char kMeshRequest[] = "MESH_REQUEST";  ///< viewers → mapper: please send everything again
inline constexpr char kStatus[] = "STATUS";             ///< every service at 1 Hz; stream
inline constexpr char kResend[] = "RESEND";             ///< whoever found a gap → the sender: please send these again
inline constexpr char kAcknowledge[] = "ACKNOWLEDGE";   ///< consumers → frame_source: a frame is done (lockstep)
inline constexpr char kEndOfStream[] = "END_OF_STREAM";   ///< frame_source → everyone, until acknowledged
inline constexpr char kControl[] = "CONTROL";             ///< egraph-run → services: save, shut down
inline constexpr char kControlReply[] = "CONTROL_REPLY";  ///< services → egraph-run: done, or why not

}  // namespace eg::messages::channels
