// SPDX-License-Identifier: Apache-2.0
// The pixel stages behind memory ports: covered fragments in, depth codes and colours written, one fragment per clock.
//
//   in -> depth --------> texture -----+-> fog -> merge -> colour write
//          ^  z read      four texels  |          colour read
//          +-- fate -> z write <-------+
//
// With DepthIsLate the tests stand behind texture, and there is a stencil test:
//
//   in -> texture ------> depth -> stencil -----+-> fog -> merge -> colour write
//         four texels      ^  z, stencil read   |          colour read
//                          +-- fate -> z, stencil write
//
// Where textures have levels (TextureHasLevels), lod stands in front of texture; where two of them are mixed, texture
// reads eight texels.
//
// Draw state: what may change between triangles. A transfer on `draw` holds for all fragments that are accepted on later
// clocks. The stages look it up by the slot that a fragment carries; draw_ready_o waits until no fragment of the next
// slot is in flight.
//
// Frame state: the constants b, c1, c0, scale and lod_a (A'), the picture's size, the fog's table, and k of each zone of lod. It
// must stay as it is while idle_o is 0. idle_o tells that every fragment has left and that all it writes was accepted.
//
// A read that is accepted on a later clock than a write must see what was written. Answers come in the order of requests.
module pixel_pipe (
    input  logic clk_i,
    input  logic rst_ni,
    output logic idle_o,
    // Frame state.
    input  logic [bitspan_pixel_pkg::SetupBW-1:0] b_i,
    input  logic [bitspan_pixel_pkg::DepthC1W-1:0] c1_i,
    input  logic [bitspan_pixel_pkg::DepthC0W-1:0] c0_i,
    input  logic [bitspan_pixel_pkg::FogScaleW-1:0] scale_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] width_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] height_i,
    input  logic load_i,
    input  logic load_threshold_i,
    input  logic [bitspan_pixel_pkg::FogIndexW-1:0] load_place_i,
    input  logic [bitspan_pixel_pkg::FogLoadW-1:0] load_data_i,
    input  logic [bitspan_pixel_pkg::DistanceAW-1:0] lod_a_i,
    input  logic load_k_i,
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] load_k_place_i,
    input  logic [bitspan_pixel_pkg::LodKW-1:0] load_k_data_i,
    // Draw state, as depth, texture, stencil, fog and merge describe it.
    input  logic draw_valid_i,
    output logic draw_ready_o,
    input  logic [2:0] draw_func_i,
    input  logic draw_write_z_i,
    input  logic [bitspan_pixel_pkg::DepthBiasW-1:0] draw_bias_i,
    input  logic draw_textured_i,
    input  logic draw_bilinear_i,
    input  logic [1:0] draw_clamp_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] draw_last_i_i,
    input  logic [bitspan_pixel_pkg::TexelIndexW-1:0] draw_last_j_i,
    input  logic [bitspan_pixel_pkg::TexelPitchW-1:0] draw_pitch_i,
    input  logic [bitspan_pixel_pkg::TexelAddressW-1:0] draw_base_i,
    input  logic draw_transparent_i,
    input  logic [23:0] draw_reserved_i,
    input  logic [1:0] draw_fog_i,
    input  logic [23:0] draw_fog_color_i,
    input  logic draw_blend_i,
    input  logic draw_write_color_i,
    input  logic [3:0] draw_color_mask_i,
    input  logic [2:0] draw_alpha_func_i,
    input  logic [7:0] draw_alpha_ref_i,
    input  logic draw_alpha_zero_i,
    // The stencil test: whether there is one, what the front of a triangle has, what its back has.
    input  logic draw_stencil_test_i,
    input  logic [2:0] draw_stencil_func_i,
    input  logic [2:0] draw_stencil_fail_i,
    input  logic [2:0] draw_stencil_zfail_i,
    input  logic [2:0] draw_stencil_pass_i,
    input  logic [7:0] draw_stencil_ref_i,
    input  logic [7:0] draw_stencil_mask_i,
    input  logic [7:0] draw_stencil_write_i,
    input  logic [2:0] draw_stencil_back_func_i,
    input  logic [2:0] draw_stencil_back_fail_i,
    input  logic [2:0] draw_stencil_back_zfail_i,
    input  logic [2:0] draw_stencil_back_pass_i,
    input  logic [7:0] draw_stencil_back_ref_i,
    input  logic [7:0] draw_stencil_back_mask_i,
    input  logic [7:0] draw_stencil_back_write_i,
    // With MergeByEquation instead of `blend`: factors and operations by their numbers, the constant colour with red in its
    // lowest byte, the logic operation, 0 for none.
    input  logic [3:0] draw_src_i,
    input  logic [3:0] draw_dst_i,
    input  logic [2:0] draw_op_i,
    input  logic [3:0] draw_alpha_src_i,
    input  logic [3:0] draw_alpha_dst_i,
    input  logic [2:0] draw_alpha_op_i,
    input  logic [31:0] draw_constant_i,
    input  logic [4:0] draw_logic_i,
    // The texture's last level, and the triangle's gradients: without levels, and in modes of lod without gradients, ignored.
    input  logic [bitspan_pixel_pkg::LodLevelW-1:0] draw_last_level_i,
    input  logic [bitspan_pixel_pkg::PlaneHGradW-1:0] draw_h_x_i,
    input  logic [bitspan_pixel_pkg::PlaneHGradW-1:0] draw_h_y_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] draw_gu_x_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] draw_gu_y_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] draw_gv_x_i,
    input  logic [bitspan_pixel_pkg::PlaneGGradW-1:0] draw_gv_y_i,
    // A covered fragment.
    input  logic in_valid_i,
    output logic in_ready_o,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_x_i,
    input  logic [bitspan_pixel_pkg::CoordW-1:0] in_y_i,
    input  logic [bitspan_pixel_pkg::SpanHW-1:0] in_h_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_u_i,
    input  logic [bitspan_pixel_pkg::SpanUvW-1:0] in_v_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_r_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_g_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_b_i,
    input  logic [bitspan_pixel_pkg::SpanShadeW-1:0] in_a_i,
    input  logic [bitspan_pixel_pkg::FogFactorW-1:0] in_factor_i,  // of the fog; read with FogIsGiven
    input  logic [bitspan_pixel_pkg::SpanHW-1:0] in_line_i,  // what depth takes for h; read with DepthHasLine
    input  logic in_back_i,  // of a back face
    // The depth memory. With DepthIsLate a word holds the stencil value, too; mask tells what is written of it: bit 0 the
    // code, bit 1 the stencil value.
    output logic z_request_valid_o,
    input  logic z_request_ready_i,
    output logic [bitspan_pixel_pkg::CoordW-1:0] z_request_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] z_request_y_o,
    input  logic z_answer_valid_i,
    output logic z_answer_ready_o,
    input  logic [bitspan_pixel_pkg::DepthZW-1:0] z_answer_z_i,
    input  logic [7:0] z_answer_stencil_i,
    output logic z_write_valid_o,
    input  logic z_write_ready_i,
    output logic [bitspan_pixel_pkg::CoordW-1:0] z_write_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] z_write_y_o,
    output logic [bitspan_pixel_pkg::DepthZW-1:0] z_write_z_o,
    output logic [7:0] z_write_stencil_o,
    output logic [1:0] z_write_mask_o,
    // Four ports of the texel memory.
    output logic texel0_request_valid_o,
    input  logic texel0_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel0_request_address_o,
    input  logic texel0_answer_valid_i,
    output logic texel0_answer_ready_o,
    input  logic [31:0] texel0_answer_texel_i,
    output logic texel1_request_valid_o,
    input  logic texel1_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel1_request_address_o,
    input  logic texel1_answer_valid_i,
    output logic texel1_answer_ready_o,
    input  logic [31:0] texel1_answer_texel_i,
    output logic texel2_request_valid_o,
    input  logic texel2_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel2_request_address_o,
    input  logic texel2_answer_valid_i,
    output logic texel2_answer_ready_o,
    input  logic [31:0] texel2_answer_texel_i,
    output logic texel3_request_valid_o,
    input  logic texel3_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel3_request_address_o,
    input  logic texel3_answer_valid_i,
    output logic texel3_answer_ready_o,
    input  logic [31:0] texel3_answer_texel_i,
    // Four more, of the next level: without mixed levels they never ask.
    output logic texel4_request_valid_o,
    input  logic texel4_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel4_request_address_o,
    input  logic texel4_answer_valid_i,
    output logic texel4_answer_ready_o,
    input  logic [31:0] texel4_answer_texel_i,
    output logic texel5_request_valid_o,
    input  logic texel5_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel5_request_address_o,
    input  logic texel5_answer_valid_i,
    output logic texel5_answer_ready_o,
    input  logic [31:0] texel5_answer_texel_i,
    output logic texel6_request_valid_o,
    input  logic texel6_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel6_request_address_o,
    input  logic texel6_answer_valid_i,
    output logic texel6_answer_ready_o,
    input  logic [31:0] texel6_answer_texel_i,
    output logic texel7_request_valid_o,
    input  logic texel7_request_ready_i,
    output logic [bitspan_pixel_pkg::TexelAddressW-1:0] texel7_request_address_o,
    input  logic texel7_answer_valid_i,
    output logic texel7_answer_ready_o,
    input  logic [31:0] texel7_answer_texel_i,
    // The colour memory. Alpha is read and written only with MergeByEquation, and written where has_a is 1.
    output logic color_request_valid_o,
    input  logic color_request_ready_i,
    output logic [bitspan_pixel_pkg::CoordW-1:0] color_request_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] color_request_y_o,
    input  logic color_answer_valid_i,
    output logic color_answer_ready_o,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] color_answer_r_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] color_answer_g_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] color_answer_b_i,
    input  logic [bitspan_pixel_pkg::MergeColorW-1:0] color_answer_a_i,
    output logic color_write_valid_o,
    input  logic color_write_ready_i,
    output logic [bitspan_pixel_pkg::CoordW-1:0] color_write_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] color_write_y_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] color_write_r_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] color_write_g_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] color_write_b_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] color_write_a_o,
    output logic color_write_has_a_o,
    // Which of r, g, b, a the memory takes: red at bit 0.
    output logic [3:0] color_write_mask_o,
    // Taps: the records of docs/numeric-spec.md, as a fragment leaves a stage.
    output logic depth_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] depth_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] depth_record_y_o,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] depth_record_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] depth_record_recip_e_o,
    output logic [bitspan_pixel_pkg::DepthZW-1:0] depth_record_z_o,
    output logic [bitspan_pixel_pkg::DepthZW-1:0] depth_record_stored_o,
    output logic depth_record_pass_o,
    output logic stencil_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] stencil_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] stencil_record_y_o,
    output logic stencil_record_back_o,
    output logic [7:0] stencil_record_stored_o,
    output logic stencil_record_pass_o,
    output logic [2:0] stencil_record_op_o,
    output logic [7:0] stencil_record_value_o,
    // Without levels, 0.
    output logic lod_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] lod_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] lod_record_y_o,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] lod_record_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] lod_record_recip_e_o,
    output logic [bitspan_pixel_pkg::DistanceSW-1:0] lod_record_s_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] lod_record_u_x_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] lod_record_u_y_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] lod_record_v_x_o,
    output logic [bitspan_pixel_pkg::LodSlopeW-1:0] lod_record_v_y_o,
    output logic [bitspan_pixel_pkg::LodLambdaW-1:0] lod_record_lambda_o,
    output logic [bitspan_pixel_pkg::LodLevelW-1:0] lod_record_level_o,
    output logic [bitspan_pixel_pkg::LodFracW-1:0] lod_record_f_o,
    output logic texture_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] texture_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] texture_record_y_o,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] texture_record_i_o,
    output logic [bitspan_pixel_pkg::TexelIndexW-1:0] texture_record_j_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] texture_record_ex_o,
    output logic [bitspan_pixel_pkg::TextureFracW-1:0] texture_record_ey_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] texture_record_texel_r_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] texture_record_texel_g_o,
    output logic [bitspan_pixel_pkg::TextureMixW-1:0] texture_record_texel_b_o,
    output logic [bitspan_pixel_pkg::TextureAlphaW-1:0] texture_record_texel_a_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] texture_record_r_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] texture_record_g_o,
    output logic [bitspan_pixel_pkg::TextureColorW-1:0] texture_record_b_o,
    output logic [bitspan_pixel_pkg::TextureAlphaW-1:0] texture_record_a_o,
    output logic texture_record_killed_o,
    output logic fog_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] fog_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] fog_record_y_o,
    output logic [bitspan_pixel_pkg::FogIndexW:0] fog_record_index_o,
    output logic [bitspan_pixel_pkg::PixelRecipOutW-1:0] fog_record_recip_m_o,
    output logic [bitspan_pixel_pkg::ExponentW-1:0] fog_record_recip_e_o,
    output logic [bitspan_pixel_pkg::FogFactorW-1:0] fog_record_factor_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] fog_record_r_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] fog_record_g_o,
    output logic [bitspan_pixel_pkg::FogColorW-1:0] fog_record_b_o,
    output logic merge_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] merge_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] merge_record_y_o,
    output logic [bitspan_pixel_pkg::DepthZW-1:0] merge_record_z_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] merge_record_r_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] merge_record_g_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] merge_record_b_o,
    output logic merge_alpha_record_valid_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] merge_alpha_record_x_o,
    output logic [bitspan_pixel_pkg::CoordW-1:0] merge_alpha_record_y_o,
    output logic [bitspan_pixel_pkg::MergeColorW-1:0] merge_alpha_record_a_o
);
  localparam int Late = bitspan_pixel_pkg::DepthIsLate;
  localparam int CoordW = bitspan_pixel_pkg::CoordW;
  localparam int HW = bitspan_pixel_pkg::SpanHW;
  localparam int ZW = bitspan_pixel_pkg::DepthZW;
  localparam int UvW = bitspan_pixel_pkg::SpanUvW;
  localparam int ShadeW = bitspan_pixel_pkg::SpanShadeW;
  localparam int ColorW = bitspan_pixel_pkg::TextureColorW;
  localparam int AlphaW = bitspan_pixel_pkg::TextureAlphaW;
  localparam int IndexW = bitspan_pixel_pkg::TexelIndexW;
  localparam int PitchW = bitspan_pixel_pkg::TexelPitchW;
  localparam int AddressW = bitspan_pixel_pkg::TexelAddressW;

  // ---------------------------------------------------------------- draw state

  localparam int SlotW = bitspan_pixel_pkg::DrawSlotW;
  localparam int Slots = 1 << SlotW;
  // Wider than all fragments that the stages hold.
  localparam int CountW = $clog2(4 * bitspan_pixel_pkg::FragmentsInFlight + 512);
  logic [SlotW-1:0] slot_q, next_slot;
  logic [2:0] func_q;
  logic draw_taken, in_taken;
  assign next_slot = slot_q + SlotW'(1);
  assign draw_taken = draw_valid_i && draw_ready_o;
  assign in_taken = in_valid_i && in_ready_o;

  // Each stage's part, by slot.
  localparam int TextureStateW = 5 + 2 * IndexW + PitchW + AddressW + 24;
  localparam int FogStateW = 2 + 24;
  localparam int BiasW = bitspan_pixel_pkg::DepthBiasW;
  localparam int SideW = 4 * 3 + 3 * 8;
  localparam int StencilStateW = 2 * SideW;
  logic fate_state[Slots];
  logic [2:0] func_state[Slots];
  logic [11:0] alpha_state[Slots];
  logic test_state[Slots];
  logic [StencilStateW-1:0] stencil_state[Slots];
  logic [BiasW-1:0] bias_state[Slots];
  logic [TextureStateW-1:0] texture_state[Slots];
  logic [FogStateW-1:0] fog_state[Slots];
  logic write_color_state[Slots];
  logic [3:0] color_mask_state[Slots];
  always_ff @(posedge clk_i) begin
    if (draw_taken) begin
      func_q <= draw_func_i;
      func_state[next_slot] <= draw_func_i;
      alpha_state[next_slot] <= {draw_alpha_func_i, draw_alpha_ref_i, draw_alpha_zero_i};
      test_state[next_slot] <= draw_stencil_test_i;
      stencil_state[next_slot] <= {
        draw_stencil_back_func_i, draw_stencil_back_fail_i, draw_stencil_back_zfail_i, draw_stencil_back_pass_i,
        draw_stencil_back_ref_i, draw_stencil_back_mask_i, draw_stencil_back_write_i, draw_stencil_func_i,
        draw_stencil_fail_i, draw_stencil_zfail_i, draw_stencil_pass_i, draw_stencil_ref_i, draw_stencil_mask_i,
        draw_stencil_write_i
      };
      fate_state[next_slot] <= draw_write_z_i;
      bias_state[next_slot] <= draw_bias_i;
      texture_state[next_slot] <= {
        draw_textured_i, draw_bilinear_i, draw_clamp_i, draw_last_i_i, draw_last_j_i, draw_pitch_i, draw_base_i,
        draw_transparent_i, draw_reserved_i
      };
      fog_state[next_slot] <= {draw_fog_i, draw_fog_color_i};
      write_color_state[next_slot] <= draw_write_color_i;
      color_mask_state[next_slot] <= draw_color_mask_i;
    end
  end

  // Fragments in flight per slot; those that leave are counted a clock later. settled_q: no fragment of the slot before
  // can still be on its way to the count.
  localparam int Ways = 4;
  logic [Ways-1:0] left, left_q;
  logic [SlotW-1:0] left_slot[Ways], left_slot_q[Ways];
  logic fate_waits;
  logic in_q, settled_q;
  logic [SlotW-1:0] in_slot_q;
  logic [CountW-1:0] count_q[Slots];
  logic [Slots-1:0] none;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      slot_q <= '0;
      in_q <= 1'b0;
      left_q <= '0;
      settled_q <= 1'b0;
      draw_ready_o <= 1'b0;
      idle_o <= 1'b0;
    end else begin
      if (draw_taken) slot_q <= next_slot;
      in_q <= in_taken;
      left_q <= left;
      settled_q <= !draw_taken;
      draw_ready_o <= none[next_slot] && settled_q && !draw_taken;
      idle_o <= (&none) && !in_q && !in_taken && !fate_waits;
    end
  end
  always_ff @(posedge clk_i) begin
    in_slot_q <= slot_q;
    for (int i = 0; i < Ways; i++) left_slot_q[i] <= left_slot[i];
  end
  for (genvar s = 0; s < Slots; s++) begin : gen_count
    logic enters;
    logic [2:0] leave;
    assign enters = in_q && in_slot_q == SlotW'(s);
    assign leave = 3'(left_q[0] && left_slot_q[0] == SlotW'(s)) + 3'(left_q[1] && left_slot_q[1] == SlotW'(s)) +
                   3'(left_q[2] && left_slot_q[2] == SlotW'(s)) + 3'(left_q[3] && left_slot_q[3] == SlotW'(s));
    always_ff @(posedge clk_i or negedge rst_ni) begin
      if (!rst_ni) count_q[s] <= '0;
      else count_q[s] <= count_q[s] + CountW'(enters) - CountW'(leave);
    end
    assign none[s] = count_q[s] == '0;
  end

  // ---------------------------------------------------------------- the order of the stages

  // What stands at a fragment's slot in front of depth, and of texture, and what comes out of them.
  // Its tag is the slot; below it h, where what goes the way of h is another line; and the fog's factor where the
  // fragment brings one.
  localparam int FactorW = bitspan_pixel_pkg::FogFactorW;
  localparam int HasLine = bitspan_pixel_pkg::DepthHasLine;
  localparam int TagHW = (HasLine != 0) ? HW : 0;
  localparam int TagW = SlotW + TagHW + ((bitspan_pixel_pkg::FogIsGiven != 0) ? FactorW : 0);
  localparam int ShadesW = 2 * UvW + 4 * ShadeW;
  localparam int DepthRestW = TagW + ((Late != 0) ? 1 + 3 * ColorW + AlphaW : ShadesW);
  localparam int TextureRestW = TagW + 2 * CoordW + HW + ((Late != 0) ? 1 : ZW + 1);
  logic [TagW-1:0] in_tag, textured_tag, judged_tag;
  if (bitspan_pixel_pkg::FogIsGiven != 0) begin : gen_factor
    assign in_tag[FactorW-1:0] = in_factor_i;
  end else begin : gen_no_factor
    logic unused;
    assign unused = ^in_factor_i;
  end
  assign in_tag[TagW-1-:SlotW] = slot_q;
  logic depth_valid, depth_ready, depth_keep;
  logic [2:0] depth_func;
  logic [CoordW-1:0] depth_x, depth_y;
  logic [HW-1:0] depth_h;
  logic [DepthRestW-1:0] depth_rest, tested_rest;
  logic tested_valid, tested_ready, tested_mark, tested_pass;
  logic [CoordW-1:0] tested_x, tested_y;
  logic [HW-1:0] tested_h;
  logic [ZW-1:0] tested_z;
  logic [7:0] tested_stencil;
  logic [SlotW-1:0] tested_slot;
  assign tested_slot = tested_rest[DepthRestW-1-:SlotW];
  logic texture_valid, texture_ready;
  logic [SlotW-1:0] texture_slot;
  logic [UvW-1:0] texture_u, texture_v;
  logic [ShadeW-1:0] texture_r, texture_g, texture_b, texture_a;
  logic [TextureRestW-1:0] texture_rest, textured_rest;
  logic textured_valid, textured_ready, killed;
  logic [SlotW-1:0] textured_slot;
  logic [CoordW-1:0] textured_x, textured_y;
  logic [HW-1:0] textured_h;
  assign {textured_tag, textured_x, textured_y, textured_h} = textured_rest[TextureRestW-1-:TagW+2*CoordW+HW];
  assign textured_slot = textured_tag[TagW-1-:SlotW];

  // What comes out of the second of the two, where everything is known that may stop a fragment: lives goes on to fog.
  logic judged_valid, judged_ready, judged_mark, lives, fog_ready;
  logic [SlotW-1:0] judged_slot;
  assign judged_slot = judged_tag[TagW-1-:SlotW];
  logic [CoordW-1:0] judged_x, judged_y;
  logic [HW-1:0] judged_h;
  logic [ZW-1:0] judged_z;
  logic [ColorW-1:0] judged_r, judged_g, judged_b;
  logic [AlphaW-1:0] judged_a;
  logic [7:0] judged_stencil;
  logic fate_valid, fate_ready;
  logic [1:0] fate_write;
  // The fate, and where it lives the fragment, leave on one clock.
  assign judged_ready = fate_ready && (fog_ready || !lives);
  assign fate_valid = judged_valid && (fog_ready || !lives);
  assign fate_write[0] = lives && fate_state[judged_slot];

  // What goes the way of h, and the h of fog.
  logic [HW-1:0] in_line, fog_h;
  if (HasLine != 0) begin : gen_line
    assign in_tag[TagW-SlotW-1-:HW] = in_h_i;
    assign in_line = in_line_i;
    assign fog_h = judged_tag[TagW-SlotW-1-:HW];
    logic unused;
    assign unused = ^judged_h;
  end else begin : gen_no_line
    assign in_line = in_h_i;
    assign fog_h = judged_h;
    logic unused;
    assign unused = ^in_line_i;
  end

  if (Late != 0) begin : gen_late
    assign texture_valid = in_valid_i;
    assign in_ready_o = texture_ready;
    assign texture_slot = slot_q;
    assign {texture_u, texture_v, texture_r, texture_g, texture_b, texture_a} = {
      in_u_i, in_v_i, in_r_i, in_g_i, in_b_i, in_a_i
    };
    assign texture_rest = {in_tag, in_x_i, in_y_i, in_line, in_back_i};

    assign depth_valid = textured_valid && !killed;
    assign textured_ready = depth_ready || killed;
    assign depth_x = textured_x;
    assign depth_y = textured_y;
    assign depth_h = textured_h;
    assign depth_func = func_state[textured_slot];
    assign depth_keep = test_state[textured_slot];
    assign depth_rest = {
      textured_tag, textured_rest[0], texture_record_r_o, texture_record_g_o, texture_record_b_o, texture_record_a_o
    };

    // Without a test a fragment passes, and the plane stays as it is.
    logic test, back, judged_test;
    logic [2:0] func, fail, zfail, pass;
    logic [7:0] ref_value, mask, write;
    logic [SideW-1:0] front_side, back_side;
    assign test = test_state[tested_slot];
    assign {back_side, front_side} = stencil_state[tested_slot];
    assign back = tested_rest[DepthRestW-TagW-1];
    assign {func, fail, zfail, pass, ref_value, mask, write} = back ? back_side : front_side;
    stencil #(
        .RestW(1 + 8 + 2 * CoordW + HW + ZW + 1 + DepthRestW)
    ) u_stencil (
        .clk_i,
        .rst_ni,
        .in_valid_i(tested_valid),
        .in_ready_o(tested_ready),
        .in_stored_i(tested_stencil),
        .in_z_pass_i(tested_pass),
        .in_rest_i({test, tested_stencil, tested_x, tested_y, tested_h, tested_z, tested_mark, tested_rest}),
        .in_func_i(test ? func : 3'b111),
        .in_fail_i(fail),
        .in_zfail_i(zfail),
        .in_pass_i(pass),
        .in_ref_i(ref_value),
        .in_mask_i(mask),
        .in_write_i(write & {8{test}}),
        .out_valid_o(judged_valid),
        .out_ready_i(judged_ready),
        .out_pass_o(stencil_record_pass_o),
        .out_op_o(stencil_record_op_o),
        .out_value_o(judged_stencil),
        .out_go_o(lives),
        .out_rest_o({
          judged_test, stencil_record_stored_o, judged_x, judged_y, judged_h, judged_z, judged_mark, judged_tag,
          stencil_record_back_o, judged_r, judged_g, judged_b, judged_a
        })
    );
    assign fate_write[1] = judged_stencil != stencil_record_stored_o;
    assign stencil_record_valid_o = judged_valid && judged_ready && judged_test;
    assign stencil_record_x_o = judged_x;
    assign stencil_record_y_o = judged_y;
    assign stencil_record_value_o = judged_stencil;
    assign left[3] = judged_valid && judged_ready && !lives;
    logic unused;
    assign unused = ^func_q;
  end else begin : gen_early
    assign depth_valid = in_valid_i;
    assign in_ready_o = depth_ready;
    assign depth_x = in_x_i;
    assign depth_y = in_y_i;
    assign depth_h = in_line;
    assign depth_func = func_q;
    assign depth_keep = 1'b0;
    assign depth_rest = {in_tag, in_u_i, in_v_i, in_r_i, in_g_i, in_b_i, in_a_i};

    assign texture_valid = tested_valid;
    assign tested_ready = texture_ready;
    logic [TagW-1:0] tested_tag;
    assign {tested_tag, texture_u, texture_v, texture_r, texture_g, texture_b, texture_a} = tested_rest;
    assign texture_slot = tested_slot;
    assign texture_rest = {tested_tag, tested_x, tested_y, tested_h, tested_z, tested_mark};

    assign judged_valid = textured_valid;
    assign textured_ready = judged_ready;
    assign lives = !killed;
    assign {judged_tag, judged_x, judged_y, judged_h, judged_z, judged_mark} = textured_rest;
    assign judged_r = texture_record_r_o;
    assign judged_g = texture_record_g_o;
    assign judged_b = texture_record_b_o;
    assign judged_a = texture_record_a_o;
    assign judged_stencil = '0;
    assign fate_write[1] = 1'b0;
    assign stencil_record_valid_o = 1'b0;
    assign {stencil_record_x_o, stencil_record_y_o, stencil_record_back_o, stencil_record_stored_o} = '0;
    assign {stencil_record_pass_o, stencil_record_op_o, stencil_record_value_o} = '0;
    assign left[3] = 1'b0;
    logic unused;
    assign unused = ^{in_back_i, tested_pass, tested_stencil, func_state[slot_q], test_state[slot_q], stencil_state[slot_q],
                      textured_tag, textured_x, textured_y, textured_h};
  end
  assign left_slot[3] = judged_slot;

  // ---------------------------------------------------------------- depth

  logic record_keep;
  logic [DepthRestW-1:0] record_rest, bias_rest;
  logic [BiasW-1:0] bias;
  assign bias = bias_state[bias_rest[DepthRestW-1-:SlotW]];
  depth #(
      .RestW(DepthRestW),
      .HasStencil(Late)
  ) u_depth (
      .clk_i,
      .rst_ni,
      .b_i,
      .c1_i,
      .c0_i,
      .in_valid_i(depth_valid),
      .in_ready_o(depth_ready),
      .in_x_i(depth_x),
      .in_y_i(depth_y),
      .in_h_i(depth_h),
      .in_func_i(depth_func),
      .in_keep_i(depth_keep),
      .in_rest_i(depth_rest),
      .request_valid_o(z_request_valid_o),
      .request_ready_i(z_request_ready_i),
      .request_x_o(z_request_x_o),
      .request_y_o(z_request_y_o),
      .answer_valid_i(z_answer_valid_i),
      .answer_ready_o(z_answer_ready_o),
      .answer_z_i(z_answer_z_i),
      .answer_stencil_i(z_answer_stencil_i),
      .write_valid_o(z_write_valid_o),
      .write_ready_i(z_write_ready_i),
      .write_x_o(z_write_x_o),
      .write_y_o(z_write_y_o),
      .write_z_o(z_write_z_o),
      .write_stencil_o(z_write_stencil_o),
      .write_mask_o(z_write_mask_o),
      .bias_i(bias),
      .bias_rest_o(bias_rest),
      .out_valid_o(tested_valid),
      .out_ready_i(tested_ready),
      .out_x_o(tested_x),
      .out_y_o(tested_y),
      .out_h_o(tested_h),
      .out_z_o(tested_z),
      .out_mark_o(tested_mark),
      .out_pass_o(tested_pass),
      .out_stencil_o(tested_stencil),
      .out_rest_o(tested_rest),
      .fate_valid_i(fate_valid),
      .fate_ready_o(fate_ready),
      .fate_x_i(judged_x),
      .fate_y_i(judged_y),
      .fate_z_i(judged_z),
      .fate_mark_i(judged_mark),
      .fate_write_i(fate_write),
      .fate_stencil_i(judged_stencil),
      .fate_waits_o(fate_waits),
      .record_valid_o(depth_record_valid_o),
      .record_x_o(depth_record_x_o),
      .record_y_o(depth_record_y_o),
      .record_recip_m_o(depth_record_recip_m_o),
      .record_recip_e_o(depth_record_recip_e_o),
      .record_z_o(depth_record_z_o),
      .record_stored_o(depth_record_stored_o),
      .record_pass_o(depth_record_pass_o),
      .record_keep_o(record_keep),
      .record_rest_o(record_rest)
  );
  assign left[0] = depth_record_valid_o && !depth_record_pass_o && !record_keep;
  assign left_slot[0] = record_rest[DepthRestW-1-:SlotW];
  logic unused_record;
  assign unused_record = ^{record_rest[DepthRestW-SlotW-1:0], bias_rest[DepthRestW-SlotW-1:0]};

  // ---------------------------------------------------------------- lod

  // Its part of the draw state, by slot: the last level, and the gradients.
  localparam int LevelW = bitspan_pixel_pkg::LodLevelW;
  localparam int ShareW = bitspan_pixel_pkg::LodFracW;
  localparam int HGradW = bitspan_pixel_pkg::PlaneHGradW;
  localparam int GGradW = bitspan_pixel_pkg::PlaneGGradW;
  localparam int HasLevels = bitspan_pixel_pkg::TextureHasLevels;
  localparam int LodStateW = LevelW + 2 * HGradW + 4 * GGradW;
  localparam int LodRestW = TextureRestW + ShadesW;
  logic levelled_valid, levelled_ready;
  logic [LodRestW-1:0] texture_all, levelled_all;
  assign texture_all = {texture_rest, texture_u, texture_v, texture_r, texture_g, texture_b, texture_a};
  logic [TextureRestW-1:0] levelled_rest;
  logic [UvW-1:0] levelled_u, levelled_v;
  logic [ShadeW-1:0] levelled_r, levelled_g, levelled_b, levelled_a;
  assign {levelled_rest, levelled_u, levelled_v, levelled_r, levelled_g, levelled_b, levelled_a} = levelled_all;
  logic [SlotW-1:0] levelled_slot;
  logic [CoordW-1:0] levelled_x, levelled_y;
  assign levelled_slot = levelled_rest[TextureRestW-1-:SlotW];
  assign {levelled_x, levelled_y} = levelled_rest[TextureRestW-TagW-1-:2*CoordW];
  logic [LevelW-1:0] level;
  logic [ShareW-1:0] share;
  if (HasLevels != 0) begin : gen_lod
    logic [LodStateW-1:0] lod_state[Slots];
    always_ff @(posedge clk_i) begin
      if (draw_taken) begin
        lod_state[next_slot] <= {
          draw_last_level_i, draw_h_x_i, draw_h_y_i, draw_gu_x_i, draw_gu_y_i, draw_gv_x_i, draw_gv_y_i
        };
      end
    end
    logic [LevelW-1:0] last_level;
    logic [HGradW-1:0] h_x, h_y;
    logic [GGradW-1:0] gu_x, gu_y, gv_x, gv_y;
    assign {last_level, h_x, h_y, gu_x, gu_y, gv_x, gv_y} = lod_state[texture_slot];
    lod #(
        .RestW(LodRestW)
    ) u_lod (
        .clk_i,
        .rst_ni,
        .b_i,
        .a_i(lod_a_i),
        .load_i(load_k_i),
        .load_place_i(load_k_place_i),
        .load_data_i(load_k_data_i),
        .in_valid_i(texture_valid),
        .in_ready_o(texture_ready),
        .in_h_i(texture_rest[TextureRestW-((HasLine != 0) ? SlotW : TagW+2*CoordW)-1-:HW]),
        .in_u_i(texture_u),
        .in_v_i(texture_v),
        .in_h_x_i(h_x),
        .in_h_y_i(h_y),
        .in_gu_x_i(gu_x),
        .in_gu_y_i(gu_y),
        .in_gv_x_i(gv_x),
        .in_gv_y_i(gv_y),
        .in_last_i(last_level),
        .in_rest_i(texture_all),
        .out_valid_o(levelled_valid),
        .out_ready_i(levelled_ready),
        .out_recip_m_o(lod_record_recip_m_o),
        .out_recip_e_o(lod_record_recip_e_o),
        .out_s_o(lod_record_s_o),
        .out_u_x_o(lod_record_u_x_o),
        .out_u_y_o(lod_record_u_y_o),
        .out_v_x_o(lod_record_v_x_o),
        .out_v_y_o(lod_record_v_y_o),
        .out_lambda_o(lod_record_lambda_o),
        .out_level_o(level),
        .out_f_o(share),
        .out_rest_o(levelled_all)
    );
    assign lod_record_valid_o = levelled_valid && levelled_ready;
    assign lod_record_x_o = levelled_x;
    assign lod_record_y_o = levelled_y;
    assign lod_record_level_o = level;
    assign lod_record_f_o = share;
  end else begin : gen_no_lod
    assign levelled_valid = texture_valid;
    assign texture_ready = levelled_ready;
    assign levelled_all = texture_all;
    assign level = '0;
    assign share = '0;
    assign lod_record_valid_o = 1'b0;
    assign {lod_record_x_o, lod_record_y_o, lod_record_recip_m_o, lod_record_recip_e_o, lod_record_s_o} = '0;
    assign {lod_record_u_x_o, lod_record_u_y_o, lod_record_v_x_o, lod_record_v_y_o} = '0;
    assign {lod_record_lambda_o, lod_record_level_o, lod_record_f_o} = '0;
    logic unused;
    assign unused = ^{draw_last_level_i, draw_h_x_i, draw_h_y_i, draw_gu_x_i, draw_gu_y_i, draw_gv_x_i, draw_gv_y_i,
                      lod_a_i, load_k_i, load_k_place_i, load_k_data_i, texture_slot, levelled_x, levelled_y};
  end

  // ---------------------------------------------------------------- texture

  logic use_texture, use_bilinear, use_transparent;
  logic [1:0] use_clamp;
  logic [IndexW-1:0] last_i, last_j;
  logic [PitchW-1:0] pitch;
  logic [AddressW-1:0] base;
  logic [23:0] reserved;
  assign {use_texture, use_bilinear, use_clamp, last_i, last_j, pitch, base, use_transparent, reserved} =
      texture_state[levelled_slot];
  // The alpha test looks its part up where a fragment leaves the stage.
  logic [2:0] alpha_func;
  logic [7:0] alpha_ref;
  logic alpha_keeps_zero;
  logic [TextureRestW-1:0] alpha_rest;
  assign {alpha_func, alpha_ref, alpha_keeps_zero} = alpha_state[alpha_rest[TextureRestW-1-:SlotW]];
  logic unused_alpha_rest;
  assign unused_alpha_rest = ^alpha_rest[TextureRestW-SlotW-1:0];
  texture #(
      .RestW(TextureRestW)
  ) u_texture (
      .clk_i,
      .rst_ni,
      .in_valid_i(levelled_valid),
      .in_ready_o(levelled_ready),
      .in_u_i(levelled_u),
      .in_v_i(levelled_v),
      .in_r_i(levelled_r),
      .in_g_i(levelled_g),
      .in_b_i(levelled_b),
      .in_a_i(levelled_a),
      .in_level_i(level),
      .in_f_i(share),
      .in_rest_i(levelled_rest),
      .in_textured_i(use_texture),
      .in_bilinear_i(use_bilinear),
      .in_clamp_i(use_clamp),
      .in_last_i_i(last_i),
      .in_last_j_i(last_j),
      .in_pitch_i(pitch),
      .in_base_i(base),
      .in_transparent_i(use_transparent),
      .in_reserved_i(reserved),
      .alpha_func_i(alpha_func),
      .alpha_ref_i(alpha_ref),
      .alpha_keeps_zero_i(alpha_keeps_zero),
      .alpha_rest_o(alpha_rest),
      .request0_valid_o(texel0_request_valid_o),
      .request0_ready_i(texel0_request_ready_i),
      .request0_address_o(texel0_request_address_o),
      .answer0_valid_i(texel0_answer_valid_i),
      .answer0_ready_o(texel0_answer_ready_o),
      .answer0_texel_i(texel0_answer_texel_i),
      .request1_valid_o(texel1_request_valid_o),
      .request1_ready_i(texel1_request_ready_i),
      .request1_address_o(texel1_request_address_o),
      .answer1_valid_i(texel1_answer_valid_i),
      .answer1_ready_o(texel1_answer_ready_o),
      .answer1_texel_i(texel1_answer_texel_i),
      .request2_valid_o(texel2_request_valid_o),
      .request2_ready_i(texel2_request_ready_i),
      .request2_address_o(texel2_request_address_o),
      .answer2_valid_i(texel2_answer_valid_i),
      .answer2_ready_o(texel2_answer_ready_o),
      .answer2_texel_i(texel2_answer_texel_i),
      .request3_valid_o(texel3_request_valid_o),
      .request3_ready_i(texel3_request_ready_i),
      .request3_address_o(texel3_request_address_o),
      .answer3_valid_i(texel3_answer_valid_i),
      .answer3_ready_o(texel3_answer_ready_o),
      .answer3_texel_i(texel3_answer_texel_i),
      .request4_valid_o(texel4_request_valid_o),
      .request4_ready_i(texel4_request_ready_i),
      .request4_address_o(texel4_request_address_o),
      .answer4_valid_i(texel4_answer_valid_i),
      .answer4_ready_o(texel4_answer_ready_o),
      .answer4_texel_i(texel4_answer_texel_i),
      .request5_valid_o(texel5_request_valid_o),
      .request5_ready_i(texel5_request_ready_i),
      .request5_address_o(texel5_request_address_o),
      .answer5_valid_i(texel5_answer_valid_i),
      .answer5_ready_o(texel5_answer_ready_o),
      .answer5_texel_i(texel5_answer_texel_i),
      .request6_valid_o(texel6_request_valid_o),
      .request6_ready_i(texel6_request_ready_i),
      .request6_address_o(texel6_request_address_o),
      .answer6_valid_i(texel6_answer_valid_i),
      .answer6_ready_o(texel6_answer_ready_o),
      .answer6_texel_i(texel6_answer_texel_i),
      .request7_valid_o(texel7_request_valid_o),
      .request7_ready_i(texel7_request_ready_i),
      .request7_address_o(texel7_request_address_o),
      .answer7_valid_i(texel7_answer_valid_i),
      .answer7_ready_o(texel7_answer_ready_o),
      .answer7_texel_i(texel7_answer_texel_i),
      .out_valid_o(textured_valid),
      .out_ready_i(textured_ready),
      .out_i_o(texture_record_i_o),
      .out_j_o(texture_record_j_o),
      .out_ex_o(texture_record_ex_o),
      .out_ey_o(texture_record_ey_o),
      .out_texel_r_o(texture_record_texel_r_o),
      .out_texel_g_o(texture_record_texel_g_o),
      .out_texel_b_o(texture_record_texel_b_o),
      .out_texel_a_o(texture_record_texel_a_o),
      .out_r_o(texture_record_r_o),
      .out_g_o(texture_record_g_o),
      .out_b_o(texture_record_b_o),
      .out_a_o(texture_record_a_o),
      .out_killed_o(killed),
      .out_rest_o(textured_rest)
  );

  assign left[1] = textured_valid && textured_ready && killed;
  assign left_slot[1] = textured_slot;
  assign texture_record_valid_o = textured_valid && textured_ready;
  assign texture_record_x_o = textured_x;
  assign texture_record_y_o = textured_y;
  assign texture_record_killed_o = killed;

  // ---------------------------------------------------------------- fog

  logic [1:0] fog_mode;
  logic [23:0] fog_color;
  assign {fog_mode, fog_color} = fog_state[judged_slot];
  logic fogged_valid, fogged_ready;
  logic [SlotW-1:0] fogged_slot;
  logic [ZW-1:0] fogged_z;
  logic [AlphaW-1:0] fogged_a;
  fog #(
      .RestW(SlotW + 2 * CoordW + ZW + AlphaW)
  ) u_fog (
      .clk_i,
      .rst_ni,
      .load_i,
      .load_threshold_i,
      .load_place_i,
      .load_data_i,
      .in_valid_i(judged_valid && lives && fate_ready),
      .in_ready_o(fog_ready),
      .in_x_i(judged_x),
      .in_y_i(judged_y),
      .in_h_i(fog_h),
      .in_r_i(judged_r),
      .in_g_i(judged_g),
      .in_b_i(judged_b),
      .in_factor_i(FactorW'(judged_tag)),
      .in_rest_i({judged_slot, judged_x, judged_y, judged_z, judged_a}),
      .in_mode_i(fog_mode),
      .in_color_i(fog_color),
      .in_width_i(width_i),
      .in_height_i(height_i),
      .in_constant_b_i(b_i),
      .in_scale_i(scale_i),
      .out_valid_o(fogged_valid),
      .out_ready_i(fogged_ready),
      .out_index_o(fog_record_index_o),
      .out_recip_m_o(fog_record_recip_m_o),
      .out_recip_e_o(fog_record_recip_e_o),
      .out_factor_o(fog_record_factor_o),
      .out_r_o(fog_record_r_o),
      .out_g_o(fog_record_g_o),
      .out_b_o(fog_record_b_o),
      .out_rest_o({fogged_slot, fog_record_x_o, fog_record_y_o, fogged_z, fogged_a})
  );
  assign fog_record_valid_o = fogged_valid && fogged_ready;

  // ---------------------------------------------------------------- merge

  logic blend, reads, write_color;
  assign write_color = write_color_state[fogged_slot];
  logic [SlotW+ZW-1:0] joined_rest;
  logic [3:0] joined_src, joined_dst, joined_alpha_src, joined_alpha_dst;
  logic [2:0] joined_op, joined_alpha_op;
  logic [31:0] joined_constant;
  logic [4:0] joined_logic;
  logic joined_has_a;
  if (bitspan_pixel_pkg::MergeByEquation != 0) begin : gen_equation
    // What decides on a read is looked up in front of the scoreboard, the rest where a colour joins what is stored.
    localparam int EquationW = 4 * 4 + 2 * 3 + 32 + 5 + 1;
    logic by_alpha, always_reads, changes_alpha;
    logic [1:0] needs_state[Slots];
    logic [EquationW-1:0] equation_state[Slots];
    blend_needs u_needs (
        .src_i(draw_src_i),
        .dst_i(draw_dst_i),
        .op_i(draw_op_i),
        .alpha_src_i(draw_alpha_src_i),
        .alpha_dst_i(draw_alpha_dst_i),
        .alpha_op_i(draw_alpha_op_i),
        .logic_i(draw_logic_i),
        .by_alpha_o(by_alpha),
        .reads_o(always_reads),
        .changes_alpha_o(changes_alpha)
    );
    always_ff @(posedge clk_i) begin
      if (draw_taken) begin
        needs_state[next_slot] <= {by_alpha, always_reads};
        equation_state[next_slot] <= {
          draw_src_i, draw_dst_i, draw_op_i, draw_alpha_src_i, draw_alpha_dst_i, draw_alpha_op_i, draw_constant_i,
          draw_logic_i, changes_alpha
        };
      end
    end
    assign {blend, reads} = needs_state[fogged_slot];
    assign {joined_src, joined_dst, joined_op, joined_alpha_src, joined_alpha_dst, joined_alpha_op, joined_constant,
            joined_logic, joined_has_a} = equation_state[joined_rest[ZW+:SlotW]];
    logic unused;
    assign unused = ^{draw_blend_i, joined_rest[ZW-1:0]};
  end else begin : gen_by_alpha
    logic blend_state[Slots];
    always_ff @(posedge clk_i) begin
      if (draw_taken) blend_state[next_slot] <= draw_blend_i;
    end
    assign blend = blend_state[fogged_slot];
    assign reads = 1'b0;
    assign {joined_src, joined_dst, joined_op, joined_alpha_src, joined_alpha_dst, joined_alpha_op, joined_constant,
            joined_logic, joined_has_a} = '0;
    logic unused;
    assign unused = ^{draw_src_i, draw_dst_i, draw_op_i, draw_alpha_src_i, draw_alpha_dst_i, draw_alpha_op_i,
                      draw_constant_i, draw_logic_i, joined_rest};
  end
  merge #(
      .RestW(SlotW + ZW)
  ) u_merge (
      .clk_i,
      .rst_ni,
      .in_valid_i(fogged_valid),
      .in_ready_o(fogged_ready),
      .in_x_i(fog_record_x_o),
      .in_y_i(fog_record_y_o),
      .in_r_i(fog_record_r_o),
      .in_g_i(fog_record_g_o),
      .in_b_i(fog_record_b_o),
      .in_a_i(fogged_a),
      .in_blend_i(blend),
      .in_reads_i(reads),
      .in_write_i(write_color),
      .in_rest_i({fogged_slot, fogged_z}),
      .joined_rest_o(joined_rest),
      .joined_src_i(joined_src),
      .joined_dst_i(joined_dst),
      .joined_op_i(joined_op),
      .joined_alpha_src_i(joined_alpha_src),
      .joined_alpha_dst_i(joined_alpha_dst),
      .joined_alpha_op_i(joined_alpha_op),
      .joined_constant_i(joined_constant),
      .joined_logic_i(joined_logic),
      .joined_has_a_i(joined_has_a),
      .request_valid_o(color_request_valid_o),
      .request_ready_i(color_request_ready_i),
      .request_x_o(color_request_x_o),
      .request_y_o(color_request_y_o),
      .answer_valid_i(color_answer_valid_i),
      .answer_ready_o(color_answer_ready_o),
      .answer_r_i(color_answer_r_i),
      .answer_g_i(color_answer_g_i),
      .answer_b_i(color_answer_b_i),
      .answer_a_i(color_answer_a_i),
      .write_valid_o(color_write_valid_o),
      .write_ready_i(color_write_ready_i),
      .write_x_o(color_write_x_o),
      .write_y_o(color_write_y_o),
      .write_r_o(color_write_r_o),
      .write_g_o(color_write_g_o),
      .write_b_o(color_write_b_o),
      .write_a_o(color_write_a_o),
      .write_has_a_o(color_write_has_a_o),
      .record_valid_o(merge_record_valid_o),
      .record_rest_o({left_slot[2], merge_record_z_o})
  );
  assign left[2] = merge_record_valid_o;
  assign color_write_mask_o = color_mask_state[left_slot[2]];
  assign merge_record_x_o = color_write_x_o;
  assign merge_record_y_o = color_write_y_o;
  assign merge_record_r_o = color_write_r_o;
  assign merge_record_g_o = color_write_g_o;
  assign merge_record_b_o = color_write_b_o;
  assign merge_alpha_record_valid_o = merge_record_valid_o && color_write_has_a_o;
  assign merge_alpha_record_x_o = color_write_x_o;
  assign merge_alpha_record_y_o = color_write_y_o;
  assign merge_alpha_record_a_o = color_write_a_o;
endmodule
