// tinygltf, compiled into this layer from its header: without file access, without image decoders, and under a name of
// its own. libdraco carries another version of tinygltf and exports its symbols, so that a program which links both
// libraries calls the one with the objects of the other.
#pragma once

#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define tinygltf orbis_tinygltf
#include <tiny_gltf.h>
#undef tinygltf

namespace tinygltf = orbis_tinygltf;
