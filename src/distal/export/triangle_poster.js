"use strict";(()=>{function $(b){return Uint8Array.from(atob(b),u=>u.charCodeAt(0))}var I="dtr1";var J=[[[[0,0],[1,1],[0,1]],[[1,1],[0,0],[1,0]]],[[[1,0],[0,1],[0,0]],[[0,1],[1,0],[1,1]]]],O=8,X=2409,Q=8,Z=2048,ee=65405,te=131,D=[1781,1241,953,773,650,561,493,440,398,362,333,308,286,268,251,237,224,212,202,192,184,176,169,162,156,150,145,140,135,131,127,123,119,116,113,110,107,104,102,99,97],U=12,P=16;var re=0,ne=128,oe=640,se=694,ae=695,ie=711,ce=719,me=735,ue=895,le=896,W=2336,fe=2354,pe=2402,j=2405,ge=64,be=.5,de=36,he=1.25,xe=4,ve=`#version 300 es
precision highp float;
precision highp int;
struct SeenTriangleCorner {
vec4 place;
vec3 outer;
float away;
};
vec3 outer_code(int corner, vec3 a, vec3 b, vec3 c, vec2 cut) {
vec3 first = mix(0.5 * (b + c), a, bvec3(cut.x < 0.0));
return mix(mix(c, b, bvec3(corner == 1)), first, bvec3(corner == 0));
}
float cut_distance(vec2 p, vec2 a, vec2 b, vec2 c, vec2 cut) {
vec2 first = mix(a, b, (max(cut.x, 0.0) + 0.5) * 0.125);
vec2 second = mix(a, c, (max(cut.y, 0.0) + 0.5) * 0.125);
vec2 along = second - first;
vec2 across = vec2(-along.y, along.x) / length(along);
float away = dot(p - first, across);
float side = dot(a - first, across);
return mix(mix(-away, away, side > 0.0), -10000.0, cut.x < 0.0);
}
SeenTriangleCorner seen_corner(int corner, vec4 ab, vec2 c, vec3 code_a, vec3 code_b, vec3 code_c,
vec2 cut, vec2 size) {
vec2 p = mix(mix(c, ab.zw, bvec2(corner == 1)), ab.xy, bvec2(corner == 0));
vec2 place = (p - vec2(0.125, 0.0)) / size * 2.0 - 1.0;
vec3 outer = outer_code(corner, code_a, code_b, code_c, cut);
return SeenTriangleCorner(vec4(place.x, -place.y, 0.0, 1.0), outer,
cut_distance(p, ab.xy, ab.zw, c, cut));
}`,Ee=`#version 300 es
precision highp float;
precision highp int;
vec3 mixed_code(vec3 outer, vec3 inner, float away, float scale) {
return mix(outer, inner, clamp(away * scale + 0.5, 0.0, 1.0));
}
vec3 display_values(vec3 code) {
float rest = code.x - code.z;
return clamp(vec3(rest + code.y, code.x + code.z, rest - code.y) / 255.0, 0.0, 1.0);
}
vec4 seen_color(vec3 outer, vec3 inner, float away, float scale) {
return vec4(display_values(mixed_code(outer, inner, away, scale)), 1.0);
}`;var F=class{#o=new Uint16Array(X).fill(32768);#s=new Uint8Array(X);#r;#n;#e=4294967295;#t=0;constructor(u,d){this.#r=u,this.#n=d;for(let c=0;c<4;c++)this.#a()}bit(u){let d=this.#o[u],c=this.#s[u],g=(this.#e>>>16)*d,S=this.#t<g?1:0;for(S?this.#e=g:(this.#t-=g,this.#e-=g),this.#o[u]=d+(((S?ee:te)-d)*D[c]>>12),c<D.length-1&&(this.#s[u]=c+1);this.#e<1<<24;)this.#e*=256,this.#a();return S}number(u){for(let g=0;g<U;g++)if(!this.bit(u+g))return g;let d=0;for(;this.bit(u+U);)d++;let c=1;for(;d--;)c=2*c+this.bit(u+U+1);return c+U-1}signed(u,d){let c=this.number(u);return c&&this.bit(d)?-c:c}#a(){if(this.#n>=this.#r.length)throw new Error("The picture's data ends too early.");this.#t=(this.#t<<8|this.#r[this.#n++])>>>0}};var L=17;function we(b){if(String.fromCharCode(...b.subarray(0,I.length))!==I)throw new Error("This is no picture as triangles of this version.");let d=new DataView(b.buffer,b.byteOffset+I.length),c=d.getUint16(0,!0),g=d.getUint16(2,!0),S=d.getUint8(4)/4;if(!c||!g||c>4096||g>4096)throw new Error("The picture's size is wrong.");let n=new F(b,9),i=2;for(;i<Math.min(c,g);)i*=2;let A=Math.ceil(g/i)*i,w=Math.ceil(c/i)*i,f=w+1,p=new Uint8Array(f*(A+1));for(let t=0;t<=A;t+=i)for(let r=0;r<=w;r+=i)p[t*f+r]=1;let k=t=>{let r=0;for(let e=i;e>1;e/=2){let o=e/2,s=(a,m,E,h,y,_)=>{let x=a*f+m;if(!p[x+y]||!p[x+_])return;let C=m>=e?p[x-e]:0;a>=e&&(C+=p[x-e*f],m+e<f&&(C+=p[x-e*f+e])),t(x,E,[x-h,x+h],[x+y,x+_],C,r+E)},[l,v]=[o*f,o];for(let a=o;a<=A;a+=e)for(let m=o;m<=w;m+=e){let E=((a/e|0)+(m/e|0))%2?-v:v;s(a,m,0,l+E,E-l,l-E)}for(let a=0;a<=A;a+=e)for(let m=o;m<=w;m+=e)s(a,m,1,v,a?-l:l,a<A?l:-l);for(let a=o;a<=A;a+=e)for(let m=0;m<=w;m+=e)s(a,m,1,l,m?-v:v,m<w?v:-v);r+=2}};k((t,r,e,o,s,l)=>{p[t]=n.bit(re+4*l+s)});let Y=new Float64Array(p.length),H=[],V=new Map,K=(t,r)=>Math.min(t,r)*p.length+Math.max(t,r),_e=(t,r)=>{if(t!==void 0&&t>=0){if(n.bit(se))return t;let o=n.number(ae)+1;return t+(n.bit(ie+t)?o:-o)}let e=1;for(;e<O;)e=2*e+n.bit(ce+O*r+e);return e-O},Se=(t,r)=>{let e=t.map((h,y)=>K(h,t[(y+1)%3])),o=e.map(h=>V.get(h)),s=ne+16*r,l=oe;if(o.forEach((h,y)=>{let _=h===void 0?0:h<0?2:1;s+=[0,4,1][_],l+=2*3**y*_,V.set(e[y],-1)}),!n.bit(s))return[...t,-1,-1];let v=n.bit(l)?0:n.bit(l+1)?1:2,a=[0,1,2].map(h=>t[(v+h)%3]),[m]=a,E=[0,1].map(h=>{let y=a[1+h],_=K(m,y),x=_e(o[e.indexOf(_)],h);return V.set(_,x),m>y?O-1-x:x});return[...a,...E]},B=(t,r,e,o)=>{if(Math.min(t,r,e)>=g*f||Math.min(t%f,r%f,e%f)>=c)return;let s=i/2**(o>>1),l=(t+r)/2;if(s>1&&p[l])return B(e,t,l,o+1),B(r,e,l,o+1);let v=s*s/(o%2?4:2);for(let E of[t,r,e])Y[E]+=v;let a=Math.floor(v),m=a>=Q&&a<=Z;H.push(m?Se([t,r,e],o):[t,r,e,-1,-1])};for(let t=0;t<A;t+=i)for(let r=0;r<w;r+=i)for(let e of J[(t+r)/i%2]){let[o,s,l]=e.map(([v,a])=>(t+v*i)*f+r+a*i);B(o,s,l,0)}let T=new Float64Array(3*p.length),G=(t,r)=>{let e=S*Math.sqrt(ge/Math.max(Y[t],.25));return Math.min(de,Math.max(be,e))*(r?he:1)};for(let t=0;t<=A;t+=i)for(let r=0;r<=w;r+=i){let e=t*f+r,o=r?e-i:e-i*f;for(let s=0;s<3;s++){let l=n.signed(fe+P*s,pe+s);T[3*e+s]=(e?T[3*o+s]:0)+l*G(e,s)}}let z=new Uint8Array(p.length);k((t,r,[e,o],[s,l])=>{if(!p[t])return;let v=M=>Math.abs(T[3*e+M]-T[3*o+M])/G(t,M),[a,m]=[e,o];if(v(0)+v(1)+v(2)>xe){let M=n.bit(j+2*r);!M&&n.bit(j+2*r+1)?m=e:M||(a=o)}let E=Math.min(4,31-Math.clz32(z[s]+z[l]+1)),h=n.signed(me+(2*E+r)*P,ue),y=le+(Math.min(2,Math.abs(h))*5+E)*3*P,_=3*(Math.sign(h)+1),x=n.signed(y,W+_+1),C=y+(45+Math.min(2,Math.abs(x)))*P,q=n.signed(C,W+9+_+Math.sign(x)+1);[h,x,q].forEach((M,N)=>{T[3*t+N]=(T[3*a+N]+T[3*m+N])/2+M*G(t,N)});let Te=Math.max(Math.abs(x),Math.abs(q));z[t]=1+Math.min(15,Math.abs(h))+Math.min(15,Te)});let R=new Float32Array(L*H.length);return H.forEach((t,r)=>{let e=L*r;for(let o=0;o<3;o++){let s=t[o];R[e+2*o]=s%f,R[e+2*o+1]=Math.floor(s/f),R.set(T.subarray(3*s,3*s+3),e+6+3*o)}R[e+15]=t[3],R[e+16]=t[4]}),{width:c,height:g,rows:R}}var Re=`
in vec4 ab;
in vec2 c;
in vec3 code_a;
in vec3 code_b;
in vec3 code_c;
in vec2 cut;
uniform vec2 size;
out vec3 outer;
out float away;
flat out vec3 inner;
void main() {
SeenTriangleCorner seen = seen_corner(gl_VertexID, ab, c, code_a, code_b, code_c, cut, size);
gl_Position = seen.place;
outer = seen.outer;
away = seen.away;
inner = code_a;
}
`,Pe=`
in vec3 outer;
in float away;
flat in vec3 inner;
uniform float scale;
out vec4 pixel;
void main() { pixel = seen_color(outer, inner, away, scale); }
`,Ce=[["ab",4],["c",2],["code_a",3],["code_b",3],["code_c",3],["cut",2]];function Ae(b,{width:u,height:d,rows:c},g){b.width=Math.round(u*g),b.height=Math.round(d*g);let S=new OffscreenCanvas(b.width,b.height),n=S.getContext("webgl2",{alpha:!1,antialias:!1});if(!n)throw new Error("WebGL 2 is missing.");let i=n.createProgram();if([ve+Re,Ee+Pe].forEach((w,f)=>{let p=n.createShader(f?35632:35633);n.shaderSource(p,w),n.compileShader(p),n.attachShader(i,p)}),n.linkProgram(i),!n.getProgramParameter(i,35714))throw new Error("WebGL refused the triangles.");n.useProgram(i),n.bindBuffer(34962,n.createBuffer()),n.bufferData(34962,c,35044);let A=0;for(let[w,f]of Ce){let p=n.getAttribLocation(i,w);n.enableVertexAttribArray(p),n.vertexAttribPointer(p,f,5126,!1,4*L,4*A),n.vertexAttribDivisor(p,1),A+=f}n.uniform2f(n.getUniformLocation(i,"size"),u,d),n.uniform1f(n.getUniformLocation(i,"scale"),g),n.viewport(0,0,S.width,S.height),n.drawArraysInstanced(4,0,3,c.length/L),b.getContext("2d").drawImage(S,0,0),n.getExtension("WEBGL_lose_context")?.loseContext()}var Oe=4;for(let b of document.querySelectorAll("canvas[data-triangles]"))try{let u=we($(b.dataset.triangles)),d=Math.min(b.clientWidth/u.width,b.clientHeight/u.height),c=Math.min(Oe,Math.max(1,d*(devicePixelRatio||1)));Ae(b,u,c),b.removeAttribute("data-triangles")}catch(u){console.warn(`The still picture cannot be drawn: ${u.message}`)}})();
