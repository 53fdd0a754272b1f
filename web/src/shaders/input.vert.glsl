// A hand or a controller. Pieces of three.js's own materials, so that bones and instances move what they do there.
#include <common>
#include <skinning_pars_vertex>

varying vec3 vNormal;

void main() {
#include <beginnormal_vertex>
#include <skinbase_vertex>
#include <skinnormal_vertex>
#include <defaultnormal_vertex>
#include <begin_vertex>
#include <skinning_vertex>
#include <project_vertex>
  vNormal = transformedNormal;
}
